"""Units balance: a law of physics is the same law in any system of units.

Metre, kilogram, second, ampere and kelvin are replaced by others. Every signal, constant and parameter is converted
by the unit that is declared for it (pint says how); what comes out has to be converted by the unit of its channel.
A parameter whose declared unit is wrong, or a dimensional number hidden in a formula, breaks this.
"""

from collections.abc import Mapping
from typing import Any

import pint
import pytest
import torch
from torch import Tensor

from simgap.effects import Effect, effects_of
from simgap.platforms import Joint
from simgap.simulation import FittedEffect, Simulator
from tests.pipeline.effects.responses import TIME_STEP, assert_same, telling_values
from tests.pipeline.platforms.machines import JOINT, QUADROTOR, SWERVE, identity, signals_for, some_signals

REGISTRY = pint.UnitRegistry()
SCALES = {"[length]": 3.0, "[mass]": 0.2, "[time]": 1.7, "[current]": 0.6, "[temperature]": 1.4}

SIGNALS = {
    "quadrotor": {
        "position": "m",
        "attitude": "1",
        "velocity": "m/s",
        "body_rate": "rad/s",
        "rotor_speed": "rad/s",
        "motor_command": "1",
        "battery_voltage": "V",
    },
    "swerve": {
        "chassis_velocity": ("m/s", "m/s", "rad/s"),
        "measured_chassis_velocity": ("m/s", "m/s", "rad/s"),
        "heading": "rad",
        "steer_angle": "rad",
        "steer_velocity": "rad/s",
        "drive_velocity": "rad/s",
        "drive_voltage": "V",
        "steer_voltage": "V",
        "battery_voltage": "V",
    },
    "joint": {
        "position": "rad",
        "velocity": "rad/s",
        "voltage": "V",
        "battery_voltage": "V",
        "temperature": "K",
    },
}
CONSTANTS = {
    "quadrotor": {
        "mass": "kg",
        "gravity": "m/s²",
        "thrust_coefficient": "N/(rad/s)²",
        "torque_coefficient": "N·m/(rad/s)²",
        "motor_speed_max": "rad/s",
        "nominal_voltage": "V",
        "inertia": "kg·m²",
        "rotor_positions": "m",
        "rotor_directions": "1",
        "thrust_ratios": "1",
        "torque_ratios": "1",
    },
    "swerve": {
        "mass": "kg",
        "inertia": "kg·m²",
        "wheel_radius": "m",
        "gravity": "m/s²",
        "steer_inertia": "kg·m²",
        "module_positions": "m",
        "module_offset": "rad",
        "coupling_ratio": "1",
        "creep": "m/s",
        **{f"{group}_sliding_velocity": "rad/s" for group in ("drive", "steer")},
        **{f"{group}_gear_ratio": "1" for group in ("drive", "steer")},
        **{f"{group}_nominal_voltage": "V" for group in ("drive", "steer")},
        **{f"{group}_resistance": "Ω" for group in ("drive", "steer")},
        **{f"{group}_torque_constant": "N·m/A" for group in ("drive", "steer")},
        **{f"{group}_back_emf_constant": "V/(rad/s)" for group in ("drive", "steer")},
    },
    "joint": {
        "inertia": "kg·m²",
        "gravity_torque": "N·m",
        "stiffness": "N·m/rad",
        "sliding_velocity": "rad/s",
        "resistance": "Ω",
        "torque_constant": "N·m/A",
        "gear_ratio": "1",
    },
    "sliding": {
        "inertia": "kg",
        "gravity_torque": "N",
        "stiffness": "N/m",
        "sliding_velocity": "m/s",
        "resistance": "Ω",
        "torque_constant": "N·m/A",
        "gear_ratio": "rad/m",
    },
}
SIGNALS["sliding"] = SIGNALS["joint"] | {"position": "m", "velocity": "m/s"}
MACHINES = {
    "quadrotor": (QUADROTOR, "rad"),
    "swerve": (SWERVE, "rad"),
    "joint": (JOINT, "rad"),
    # A slide has no pendulum's weight: the sine of a length means nothing.
    "sliding": (Joint(JOINT.inertia, 0.0, JOINT.stiffness, JOINT.motor), "m"),
}
CASES = [
    pytest.param(machine, effect, id=f"{machine}-{identity(effect)}")
    for machine, (platform, _) in MACHINES.items()
    for effect in effects_of(platform.kind)
]


def factor(unit: str | tuple[str, ...]) -> Tensor | float:
    """Return what a number in SI is multiplied by to be said in the other units."""
    if isinstance(unit, tuple):
        return torch.tensor([factor(entry) for entry in unit], dtype=torch.float64)
    scale = 1.0
    for dimension, power in REGISTRY.parse_units(unit.replace("·", "*")).dimensionality.items():
        scale *= SCALES[dimension] ** power
    return scale


def signals_of(machine: str, effect: Effect | None, other_units: bool) -> dict[str, Tensor]:
    platform, _ = MACHINES[machine]
    signals = some_signals(platform.kind, (3, 60), seed=1)
    assert signals.keys() == SIGNALS[machine].keys()
    if effect is not None:
        signals = signals_for(effect, (3, 60), seed=1)
    return {name: s * factor(SIGNALS[machine][name]) if other_units else s for name, s in signals.items()}


class OtherUnits(Simulator):
    """A simulator whose constants are said in other units."""

    def constants(self) -> dict[str, Any]:
        machine = "sliding" if self.position_unit == "m" else self.platform.kind
        constants = dict(super().constants())
        numbers = constants.keys() - {"channel"}
        assert numbers == CONSTANTS[machine].keys()
        return constants | {name: constants[name] * factor(CONSTANTS[machine][name]) for name in numbers}


def sides(
    simulator: Simulator, signals: Mapping[str, Tensor], time_step: float
) -> dict[str, dict[str, Tensor]]:
    balance = simulator.balance(simulator.along_time(signals, time_step))
    return {"momentum": balance.momentum, "wrench": balance.wrench, "rate": balance.rate}


def assert_balanced(machine: str, in_si: Simulator, in_other: Simulator) -> None:
    effect = in_si.effects[0].effect if in_si.effects else None
    expected = sides(in_si, signals_of(machine, effect, other_units=False), TIME_STEP)
    found = sides(in_other, signals_of(machine, effect, other_units=True), TIME_STEP * SCALES["[time]"])
    units = {channel.name: channel.unit for channel in in_si.mechanism.channels}
    for side, values in expected.items():
        per_second = SCALES["[time]"] if side == "momentum" else 1.0
        converted = {name: value * factor(units[name]) * per_second for name, value in values.items()}
        assert_same(found[side], converted, rtol=1e-9)


@pytest.mark.parametrize("machine", list(MACHINES))
def test_units_of_the_nominal_equations_balance(machine):
    platform, position_unit = MACHINES[machine]
    in_si, in_other = (kind(platform, (), position_unit) for kind in (Simulator, OtherUnits))
    assert_balanced(machine, in_si, in_other)


@pytest.mark.parametrize(("machine", "effect"), CASES)
def test_units_of_an_effect_balance(machine, effect):
    platform, position_unit = MACHINES[machine]
    units = effect.units(position_unit)
    for values in telling_values(effect):
        other = {name: value * factor(units[name]) for name, value in values.items()}
        in_si = Simulator(platform, (FittedEffect(effect, values),), position_unit)
        in_other = OtherUnits(platform, (FittedEffect(effect, other),), position_unit)
        assert_balanced(machine, in_si, in_other)


def test_a_wrong_unit_would_be_noticed():
    drag = next(effect for effect in effects_of("quadrotor") if effect.name == "rotor_drag")
    values = drag.defaults()
    wrong = {"coefficient": values["coefficient"] * factor("1/m")}
    in_si = Simulator(QUADROTOR, (FittedEffect(drag, values),))
    with pytest.raises(AssertionError):
        assert_balanced("quadrotor", in_si, OtherUnits(QUADROTOR, (FittedEffect(drag, wrong),)))
