"""Concealable effects of a quadrotor, inside and outside the catalogue, with their usual strength."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from simgap.errors import InputError
from simgap.plants.concealment import Quantity, Table, check_chosen
from simgap.platforms import Quadrotor

_SETTINGS = {"length", "frequency"}  # quantities that alone switch nothing on
_SHAPES = {"down_ratio"}  # that switch nothing on either, and are neutral where a case leaves them out
_TORQUE = {"weight": 1, "reach": 1}  # N·m
_ROTOR = {**_TORQUE, "hover_speed": -1}


def _ratio(typical: float) -> dict[str, Quantity]:
    return {"ratio": Quantity("1", typical, neutral=1.0, low=0.1, high=10.0)}


CONCEALABLE: Table = {
    "rotor_drag": {"coefficient": Quantity("1/s", 0.35)},
    "axial_inflow": {"coefficient": Quantity("1/s", 0.3)},
    "translational_lift": {"coefficient": Quantity("1/m", 0.02)},
    "body_drag": {"coefficient": Quantity("1/m", 0.04)},
    "ground_effect": {"coefficient": Quantity("m²", 0.06, powers={"reach": 2})},
    "battery_sag": {"sensitivity": Quantity("1", 0.8, high=1.5)},
    "motor_lag": {
        "time_constant": Quantity("s", 0.03),
        "down_ratio": Quantity("1", 1.4, neutral=1.0, low=0.2, high=5.0),
    },
    "command_delay": {"delay": Quantity("s", 0.02, high=0.1)},
    "rotor_fault": {
        f"loss_{rotor}": Quantity("1", 0.2 if rotor == 1 else 0.0, high=0.6) for rotor in range(1, 5)
    },
    "center_of_mass_offset": {
        "offset_x": Quantity("m", 0.05, powers={"reach": 1}, low=-0.1, high=0.1),
        "offset_y": Quantity("m", 0.0, low=-0.1, high=0.1),
    },
    "blade_flapping_moment": {"coefficient": Quantity("N·s", 0.005, powers=_TORQUE)},
    "rotor_inertia_torque": {"inertia": Quantity("kg·m²", 0.01, powers=_ROTOR)},
    "gyroscopic_torque": {"inertia": Quantity("kg·m²", 0.03, powers=_ROTOR)},
    "angular_drag": {"coefficient": Quantity("N·m·s/rad", 0.005, powers=_TORQUE)},
    "steady_wind": {
        "wind_x": Quantity("m/s", 4.0, low=-30.0, high=30.0),
        "wind_y": Quantity("m/s", 0.0, low=-30.0, high=30.0),
    },
    "slung_payload": {
        "mass_ratio": Quantity("1", 0.15, high=1.0),
        "length": Quantity("m", 0.8, low=0.05, high=10.0),
    },
    "sensor_time_offset": {"offset": Quantity("s", 0.02, low=-1.0, high=1.0)},
    "mass_error": _ratio(1.15),
    "inertia_error": _ratio(1.3),
    "thrust_coefficient_error": _ratio(0.88),
    "torque_coefficient_error": _ratio(1.3),
    "command_scale_error": _ratio(1.06),
    "yaw_trim": {"imbalance": Quantity("1", 0.1, low=-0.5, high=0.5)},
    "rotor_thrust_spread": {
        f"excess_{rotor}": Quantity("1", 0.08 if rotor == 1 else 0.0, low=-0.3, high=0.3)
        for rotor in range(1, 4)
    },
}
"""Effects by the contract's names. A wind is set by its speed; what it amounts to is a push, see `truth`."""

OUTSIDE: Table = {
    "gusts": {"speed": Quantity("m/s", 2.0)},
    "vortex_ring": {"depth": Quantity("1", 0.25, high=0.6)},
    "shifting_mass": {"travel": Quantity("m", 0.08, powers={"reach": 1}, high=0.03)},
    "thrust_fade": {"depth": Quantity("1", 0.15, high=0.5)},
    "heading_torque": {"amplitude": Quantity("N·m", 0.01, powers=_TORQUE)},
    "arm_resonance": {
        "share": Quantity("1", 0.3, high=0.6),
        "frequency": Quantity("Hz", 18.0, low=8.0, high=60.0),
    },
}
"""Physics for which the catalogue has no name."""


def machine_size(platform: Quadrotor) -> dict[str, float]:
    """Return weight, N, mean rotor arm, m, and hover rotor speed, rad/s, which scale the defaults."""
    reach = np.linalg.norm(np.array(platform.rotor_positions)[:, :2], axis=-1).mean()
    return {
        "weight": platform.mass * platform.gravity,
        "reach": float(reach),
        "hover_speed": platform.hover_rotor_speed,
    }


def named_parameters(given: Mapping[str, Any], table: Table, where: str) -> dict[str, dict[str, float]]:
    """Return what a case conceals by effect and parameter.

    What a mapping leaves out is neutral, or has its default where it is no switch (the length of a cable).

    Args:
        given: by effect, a number where it has one switch, or a mapping of parameters.
        table: `CONCEALABLE` or `OUTSIDE`.
        where: the key that errors name.

    Raises:
        InputError: for an unknown name, a value that is no number, or one out of its range.
    """
    written = {name: _mapping(name, values, table, f"{where}.{name}") for name, values in given.items()}
    check_chosen(written, table, where)
    return {name: _completed(values, table[name]) for name, values in written.items()}


def is_present(values: Mapping[str, float], quantities: Mapping[str, Quantity]) -> bool:
    """Return whether any value differs from that at which the effect is absent."""
    return any(values[name] != quantities[name].neutral for name in _switches(quantities))


def _switches(quantities: Mapping[str, Quantity]) -> list[str]:
    return [name for name in quantities if name not in _SETTINGS | _SHAPES]


def _mapping(name: str, values: Any, table: Table, where: str) -> dict[str, float]:
    if isinstance(values, Mapping):
        given = dict(values)
    else:
        names = _switches(table.get(name, {"": Quantity("1", 0.0)}))
        if len(names) > 1:
            raise InputError("has several parameters", where, f"give a mapping of {', '.join(names)}")
        given = {names[0]: values}
    for parameter, value in given.items():
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise InputError(f"must be a number, is {value!r}", f"{where}.{parameter}", "correct it")
    return given


def _completed(values: Mapping[str, float], quantities: Mapping[str, Quantity]) -> dict[str, float]:
    """Fill in what is left out: the neutral value, or the default of what is no switch."""
    return {
        name: float(values.get(name, quantity.default if name in _SETTINGS else quantity.neutral))
        for name, quantity in quantities.items()
    }
