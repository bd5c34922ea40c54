"""The regime variables over which a mismatch is mapped, such as airspeed or height."""

from collections.abc import Mapping
from dataclasses import dataclass

import torch
from torch import Tensor

_AXES = ("x", "y", "z")
_ROUNDING = 1e-9
"""Of the range of a variable, by which means over a window of one value may differ."""


@dataclass(frozen=True)
class Regime:
    """One regime variable of the machine.

    Attributes:
        name: as in the diagnosis.
        unit: its unit.
        series: (blocks, samples).
        of: the signal that it is made of.
    """

    name: str
    unit: str
    series: Tensor
    of: str


def regimes_of(kind: str, signals: Mapping[str, Tensor], position_unit: str = "rad") -> list[Regime]:
    """Return the regime variables that the signals of a platform kind allow; margins are dropped beforehand."""
    makers = {"quadrotor": _quadrotor, "joint": _joint, "swerve": _swerve}
    regimes = makers[kind](signals, position_unit)
    shared = [("battery_voltage", "V"), ("elapsed", "s")]
    return regimes + [Regime(name, unit, signals[name], name) for name, unit in shared if name in signals]


def _quadrotor(signals: Mapping[str, Tensor], position_unit: str) -> list[Regime]:
    rate, place = signals["body_rate"], list[Regime]()
    if "velocity" in signals:
        velocity = signals["velocity"]
        place = [
            Regime("airspeed", "m/s", velocity.norm(dim=-1), "velocity"),
            *(
                Regime(f"velocity_{axis}", "m/s", velocity[..., i], "velocity")
                for i, axis in enumerate(_AXES)
            ),
            Regime("height", "m", signals["position"][..., 2], "position"),
        ]
    return [
        *place,
        Regime("turning_rate", "rad/s", rate.norm(dim=-1), "body_rate"),
        *(Regime(f"body_rate_{axis}", "rad/s", rate[..., i], "body_rate") for i, axis in enumerate(_AXES)),
        Regime("mean_rotor_speed", "rad/s", signals["rotor_speed"].mean(-1), "rotor_speed"),
    ]


def _joint(signals: Mapping[str, Tensor], position_unit: str) -> list[Regime]:
    regimes = [
        Regime("velocity", f"{position_unit}/s", signals["velocity"], "velocity"),
        Regime("speed", f"{position_unit}/s", signals["velocity"].abs(), "velocity"),
        Regime("position", position_unit, signals["position"], "position"),
        Regime("effort", "N·m" if position_unit == "rad" else "N", signals["effort"], "effort"),
    ]
    extra = [("voltage", "V"), ("temperature", "°C")]
    return regimes + [Regime(name, unit, signals[name], name) for name, unit in extra if name in signals]


def _swerve(signals: Mapping[str, Tensor], position_unit: str) -> list[Regime]:
    chassis = signals["chassis_velocity"]
    steer, drive = signals["steer_velocity"], signals["drive_voltage"]
    return [
        Regime("chassis_speed", "m/s", chassis[..., :2].norm(dim=-1), "chassis_velocity"),
        Regime("chassis_velocity_x", "m/s", chassis[..., 0], "chassis_velocity"),
        Regime("chassis_velocity_y", "m/s", chassis[..., 1], "chassis_velocity"),
        Regime("chassis_rate", "rad/s", chassis[..., 2], "chassis_velocity"),
        *(Regime(f"steer_velocity_{m + 1}", "rad/s", steer[..., m], "steer_velocity") for m in range(4)),
        *(Regime(f"drive_voltage_{m + 1}", "V", drive[..., m], "drive_voltage") for m in range(4)),
    ]


def quantile_edges(values: Tensor, bins: int) -> Tensor:
    """Return the edges of bins that hold about equally many values; fewer where values repeat.

    Values that differ by rounding alone, as those of a command that is held, are one value and lie in one bin.
    """
    edges = torch.unique(torch.quantile(values, torch.linspace(0, 1, bins + 1, dtype=values.dtype)))
    rounding = _ROUNDING * (edges[-1:] - edges[:1])
    inner = edges[1:][edges.diff() > rounding]
    return torch.cat([edges[:1], inner[:-1] - rounding, inner[-1:]])


def parted_at_zero(edges: Tensor) -> Tensor:
    """Return the edges with zero among them where they lie on both sides of it: there friction changes its sign."""
    straddle = len(edges) and edges[0] < 0 < edges[-1]
    return torch.unique(torch.cat([edges, edges.new_zeros(1)])) if straddle else edges


def bin_of(values: Tensor, edges: Tensor) -> Tensor:
    """Return the bin of each value, 0 .. len(edges) − 2."""
    return (torch.bucketize(values, edges[1:-1], right=True)).clamp(0, max(len(edges) - 2, 0))


def mean_per_bin(values: Tensor, place: Tensor, bins: int) -> Tensor:
    """Return the mean of the values in each bin, NaN where it is empty."""
    total = values.new_zeros(bins).index_add(0, place, values)
    count = values.new_zeros(bins).index_add(0, place, torch.ones_like(values))
    return total / count
