"""Powertrain of a racing quadrotor: battery, speed controllers and motors in one coupled loop."""

from typing import Any

import torch
from torch import Tensor

from simgap.effects import ActuatorEffect, Parameter
from simgap.effects.effect import Signals, Values
from simgap.effects.lag import lag_step
from simgap.physics import batteries, rotors
from simgap.physics.motors import first_order_lag
from simgap.physics.shapes import Signal
from simgap.physics.speed_controllers import SpeedMap, calibrated_speed_map, steady_speed
from simgap.platforms import Quadrotor

_CELL_VOLTAGE = 3.7  # nominal, V


class Powertrain(ActuatorEffect):
    """Rotor speed from throttle through speed controllers without a speed loop, on a battery that the rotors drain.

    It is one object because its parts form one loop: speed needs power, power needs current, current lowers the
    voltage, and the voltage lowers the speed. It is not in the catalogue: a recording shows `battery_sag` and
    `motor_lag` instead.
    """

    remembers = True
    order = 0
    name = "powertrain"
    kind = "quadrotor"
    acts_on = "actuator"
    parameters = (
        Parameter("speed_constant", "rad/s", 610.0, -1e4, 1e4),
        Parameter("speed_per_voltage", "rad/s/V", -41.0, -1e3, 1e3),
        Parameter("speed_per_root", "rad/s", -2400.0, -1e4, 1e4),
        Parameter("speed_per_throttle", "rad/s", 2370.0, -1e4, 1e4),
        Parameter("speed_per_voltage_root", "rad/s/V", 163.0, -1e3, 1e3),
        Parameter("time_constant", "s", 0.033, 1e-3, 0.5),
        Parameter("efficiency", "1", 0.75, 0.1, 1.0, neutral=1.0),
        Parameter("cells", "1", 4.0, 1.0, 14.0),
        Parameter("resistance", "Ω", 0.01, 0.0, 1.0),
        Parameter("relaxation_resistance", "Ω", 0.0063, 0.0, 1.0),
        Parameter("relaxation_time", "s", 33.0, 1.0, 1e4),
        Parameter("capacity", "C", 6480.0, 100.0, 1e6, neutral=1e6),
        Parameter("charge", "1", 1.0, 0.0, 1.0, neutral=1.0),
    )
    needs = ("motor_command",)
    formula = (
        "dΩ/dt = (Ω_s − Ω) / time_constant, Ω_s = a + b·U + c·√u + d·u + e·U·√u, Σ c_d·Ω³ / efficiency = U·I, "
        "U = E(charge) − U_RC − resistance·I"
    )
    source = "Kaufmann et al. 2023, Champion-level drone racing using deep reinforcement learning, Methods"
    sentence = "The rotors follow their throttle with {time_constant} s, on a battery of {resistance} Ω."
    excitation = "throttle steps on a full and on an empty battery"

    def actuate(
        self, signals: Signals, values: Values, constants: Values, memory: Any, time_step: float
    ) -> tuple[dict[str, Signal], Any]:
        """Return the mean rotor speed over the step and the voltage it had; the memory holds what is at its end."""
        throttle = signals["motor_command"]
        before = _rested(throttle, values) if memory is None else memory
        source = _open_circuit(before["charge"], values) - before["relaxation"]
        power = rotors.shaft_power(before["speed"], constants["torque_coefficient"]).sum(-1)
        current = batteries.current_for_power(power / values["efficiency"], source, values["resistance"])
        voltage = source - values["resistance"] * current
        target = steady_speed(throttle, voltage, _speed_map(values))
        mean, speed = lag_step(before["speed"], target, values["time_constant"], time_step)
        drop = values["relaxation_resistance"] * current
        after = {
            "speed": speed,
            "charge": batteries.charge_step(before["charge"], current, values["capacity"], time_step),
            "relaxation": first_order_lag(before["relaxation"], drop, values["relaxation_time"], time_step),
        }
        return {"rotor_speed": mean, "battery_voltage": voltage}, after


def powertrain_values(platform: Quadrotor, efficiency: float = 0.75, time_constant: float = 0.033) -> dict:
    """Return powertrain values that give the platform's hover and maximum speed at nominal voltage.

    Args:
        platform: whose greatest speed, hover speed and nominal voltage the speed controllers meet.
        efficiency: of the motors; 0.75 is that of Kaufmann et al. 2023.
        time_constant: of the motors, s; 0.033 is that of Foehn et al. 2022, "Agilicious", for 5-inch propellers.
    """
    cells = max(round(platform.nominal_voltage / _CELL_VOLTAGE), 1)
    speed_map = calibrated_speed_map(
        platform.motor_speed_max, platform.hover_rotor_speed, platform.nominal_voltage, efficiency
    )
    return {
        **{p.name: p.default for p in Powertrain.parameters},
        **dict(zip([p.name for p in Powertrain.parameters], speed_map, strict=False)),
        "efficiency": efficiency,
        "time_constant": time_constant,
        "cells": float(cells),
    }


def _speed_map(values: Values) -> SpeedMap:
    return SpeedMap(*(values[parameter.name] for parameter in Powertrain.parameters[:5]))


def _open_circuit(charge: Tensor, values: Values) -> Tensor:
    return values["cells"] * batteries.open_circuit_voltage(charge)


def _rested(throttle: Tensor, values: Values) -> dict[str, Tensor]:
    """Return a battery that nothing was drawn from yet, and rotors at the speed of their first throttle."""
    charge = torch.ones_like(throttle[..., 0]) * values["charge"]
    speed = steady_speed(throttle, _open_circuit(charge, values), _speed_map(values))
    return {"speed": speed, "charge": charge, "relaxation": torch.zeros_like(charge)}
