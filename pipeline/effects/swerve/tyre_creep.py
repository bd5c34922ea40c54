"""Tyres that give way in proportion to the force on them, far below the limit of their grip."""

from typing import Any

from simgap.effects.effect import ActuatorEffect, Parameter, Signals, Values
from simgap.effects.swerve.common import wheel_speed
from simgap.physics.shapes import PerModule, Real, Signal
from simgap.platforms.swerve_mechanism import MEASURED
from simgap.platforms.swerve_slip import CREEP_ACROSS, CREEP_ALONG


class TyreCreep(ActuatorEffect):
    """A wheel that pulls turns a little faster than it rolls, and one that is pushed aside drifts a little."""

    order = 3
    name = "tyre_creep"
    kind = "swerve"
    acts_on = "drive"
    parameters = (Parameter("compliance", "1", 0.04, 0.0, 1.0),)
    needs = (MEASURED,)
    formula = (
        "slip speed = compliance · force / load · wheel speed, along and across each wheel, load = mass · gravity / 4; "
        "seen where the chassis' own motion is measured (in a simulation wheels roll, and their motors pull as much "
        "less as they would turn faster)"
    )
    source = "Pacejka 2012, Tire and vehicle dynamics, §1.2.1: the slope of force over slip at the origin"
    sentence = (
        "A wheel that pulls as hard as its load slips by a fraction {compliance} of its speed, and less in proportion; "
        "add the slip stiffness of the tyres to the simulator."
    )
    excitation = (
        "accelerate and brake at high speed, straight ahead and in curves, and record the chassis' own motion: slip "
        "turns round with the pull, which a wheel radius does not"
    )
    symptom = "The wheels are a few per cent faster than the chassis while it accelerates, and slower while it brakes."
    look_alikes = ("wheel_slip", "wheel_radius_error")

    def actuate(
        self, signals: Signals, values: Values, constants: Values, memory: Any, time_step: float
    ) -> tuple[dict[str, Signal], Any]:
        """Return how fast each tread slips along and across its wheel, and in a simulation the lesser torque."""
        rolling = wheel_speed(signals, constants) * constants["wheel_radius"]
        per_force = values["compliance"] * rolling.abs() / (0.25 * constants["mass"] * constants["gravity"])
        torque = signals["drive_torque"]
        if MEASURED not in signals:
            torque = torque / (1.0 + per_force * _motor_damping(constants))
        return {
            "drive_torque": torque,
            CREEP_ALONG: per_force * torque / constants["wheel_radius"],
            CREEP_ACROSS: -per_force * _side_force(rolling, signals, constants),
        }, None


def _motor_damping(constants: Values) -> Real | float:
    """Return the pull that a drive motor loses by back-EMF per speed of its wheel's tread, N·s/m."""
    per_speed = constants["drive_gear_ratio"] / constants["wheel_radius"]
    product = constants["drive_torque_constant"] * constants["drive_back_emf_constant"]
    return per_speed**2 * product / constants["drive_resistance"]


def _side_force(rolling: PerModule, signals: Signals, constants: Values) -> PerModule:
    """Return the force of the ground to each wheel's left that bends its path, at equal loads, (..., 4) N."""
    turning = signals["chassis_velocity"][..., 2:] + signals["steer_velocity"]
    return 0.25 * constants["mass"] * rolling * turning
