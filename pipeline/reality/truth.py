"""The answer: which effects a case conceals, and what each amounts to in the units of a diagnosis."""

from typing import Any

import numpy as np

from pipeline.platforms import Quadrotor
from pipeline.reality.airframe import Airframe
from pipeline.reality.case import CONCEALABLE, PlantCase
from pipeline.reality.flight import SETTLING, Log
from pipeline.reality.rotation import Array, matrix

KEY_SCHEMA = "simgap.key/1"


def answer_key(airframe: Airframe, platform: Quadrotor, case: PlantCase, log: Log) -> dict[str, Any]:
    """Return the key of a case; effects at their neutral strength are absent.

    A force of the plant is richer than any one number. What counts as true is its projection, over the
    flights as flown, on the law that a diagnosis would fit.
    """
    effects = []
    for name, concealable in CONCEALABLE.items():
        strength = case.strength(name)
        if strength != concealable.neutral:
            value = lumped(name, airframe, platform, log) if name in LAWS else strength
            effects.append(_entry(name, concealable.parameter, value, concealable.unit))
    damping = lumped("angular_drag", airframe, platform, log) if case.arm > 0 else 0.0
    if damping > 0:
        effects.append(_entry("angular_drag", "coefficient", damping, "N·m·s/rad"))
    return {"schema": KEY_SCHEMA, "effects": effects}


def _entry(name: str, parameter: str, value: float, unit: str) -> dict[str, Any]:
    return {"name": name, "parameters": {parameter: {"value": value, "unit": unit}}}


def lumped(name: str, airframe: Airframe, platform: Quadrotor, log: Log) -> float:
    """Return the coefficient with which a law of `LAWS` comes nearest to what an effect truly adds.

    Args:
        name: of the effect.
        airframe: the plant with the effect.
        platform: for the hover rotor speed, by which laws are scaled.
        log: the flights.
    """
    flown = slice(round(SETTLING / log.step), None, max(round(0.01 / log.step), 1))
    rotation = matrix(log.attitude[flown])
    velocity = (log.velocity[flown][..., None, :] @ rotation)[..., 0, :]
    body_rate, speed = log.body_rate[flown], log.rotor_speed[flown]
    acts_on = 1 if name == "angular_drag" else 0  # torque or specific force
    added = airframe.settled(velocity, body_rate, speed)[acts_on]
    added = added - airframe.without(name).settled(velocity, body_rate, speed)[acts_on]
    law = LAWS[name](velocity, body_rate, speed.mean(axis=-1, keepdims=True) / platform.hover_rotor_speed)
    return float((law * added).sum() / (law * law).sum())


def _rotor_drag(velocity: Array, _turning: Array, spin: Array) -> Array:
    return -spin * velocity * [1.0, 1.0, 0.0]


def _axial_inflow(velocity: Array, _turning: Array, spin: Array) -> Array:
    return -spin * velocity * [0.0, 0.0, 1.0]


def _translational_lift(velocity: Array, _turning: Array, _spin: Array) -> Array:
    return (velocity[..., :2] ** 2).sum(axis=-1, keepdims=True) * np.array([0.0, 0.0, 1.0])


def _body_drag(velocity: Array, _turning: Array, _spin: Array) -> Array:
    return -np.linalg.norm(velocity, axis=-1, keepdims=True) * velocity


def _angular_drag(_velocity: Array, turning: Array, _spin: Array) -> Array:
    return -turning


LAWS = {
    "rotor_drag": _rotor_drag,
    "axial_inflow": _axial_inflow,
    "translational_lift": _translational_lift,
    "body_drag": _body_drag,
    "angular_drag": _angular_drag,
}
"""Specific force or torque per unit of coefficient, from airspeed, body rate and relative rotor speed."""
