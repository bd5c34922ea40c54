"""Pre-sliding friction of a joint (Dahl model).

The deflection depends on the distance moved and not on the speed, so it follows exactly from the recorded positions.
If the axis moves within a step, the wrench carries the deflection forward from the step's position to the present
one.
"""

from typing import Any

import torch
from torch import Tensor

from simgap.effects.effect import ActuatorEffect, Parameter, Signals, Values, WrenchEffect
from simgap.effects.joint.common import on_axis
from simgap.effects.recurrence import accumulated
from simgap.effects.scan import scan
from simgap.effects.sizes import size_of, sizes_of
from simgap.physics.shapes import Channels, Signal

_LEVELS = (
    0.05,
    0.5,
)  # of the typical effort: friction takes some of it, seldom more; the level enters linearly
_PARTS = (
    0.0,
    0.2,
    0.4,
    0.6,
    0.8,
    0.95,
)  # of the way from the least to the greatest displacement, in logarithm


class Hysteresis(ActuatorEffect, WrenchEffect):
    """Friction builds up over a short distance after each reversal, like a spring (Dahl model)."""

    remembers = True
    linear = False
    order = 3
    name = "hysteresis"
    kind = "joint"
    acts_on = "torque"
    parameters = (
        Parameter("level", "N·m", 0.1, 0.0, 1e6),
        Parameter("displacement", "rad", 0.05, 1e-5, 10.0, neutral=0.1),
    )
    needs = ("position",)
    formula = "torque = −level · z, dz/dt = (velocity − |velocity| · z) / displacement"
    source = "Dahl 1976, Solid friction damping of mechanical vibrations (AIAA J. 14), with exponent 1"
    sentence = (
        "Friction builds up to {level} {level_unit} over {displacement} {displacement_unit} after each "
        "reversal; add hysteresis to the simulator."
    )
    excitation = "swing slowly at several small amplitudes, with many reversals"
    symptom = "Effort over position forms a loop after each reversal, of the same width at any speed."
    look_alikes = ("backlash", "coulomb_friction", "linear_stiffness")

    def starts(self) -> list[dict[str, float]]:
        """Start from a scan: without a level the displacement has no gradient."""
        return scan(level=_LEVELS, displacement=(0.001, 0.004, 0.015, 0.06, 0.2, 0.8))

    def starts_in(self, signals: Signals, constants: Values | None = None) -> list[dict[str, float]]:
        """Start between the travel in a sample (shorter is friction) and the whole travel (longer is a spring)."""
        level, displacement = self.parameters_in(signals, constants)
        sizes = sizes_of(self.kind, signals, constants or {})
        position = signals["position"]
        least = max(float(position.diff(dim=1).abs().median()), displacement.low)
        most = max(sizes.get("travel", 1.0), least)
        between = [least * (most / least) ** part for part in _PARTS]
        size = size_of(level.unit, sizes)
        return scan(level=[size * share for share in _LEVELS], displacement=between)

    def actuate(
        self, signals: Signals, values: Values, constants: Values, memory: Any, time_step: float
    ) -> tuple[dict[str, Signal], Any]:
        """Return the relative deflection and its position; it starts at zero."""
        position = signals["position"]
        deflection, place = (torch.zeros_like(position), position) if memory is None else memory
        deflection = _deflected(deflection, position - place, values["displacement"])
        out = {"hysteresis_deflection": deflection, "hysteresis_position": position}
        return out, (deflection, position)

    def along_time(
        self, signals: Signals, values: Values, constants: Values, time_step: float
    ) -> dict[str, Signal]:
        """Return blocks with the deflection, a linear recurrence from sample to sample."""
        position, displacement = signals["position"], values["displacement"]
        way = torch.diff(position, dim=1, prepend=position[:, :1])
        towards, left = _remainder(way, displacement)
        # Rounding apart, the deflection never passes its level.
        deflection = accumulated(left, towards * (1.0 - left)).clamp(-1.0, 1.0)
        return {**signals, "hysteresis_deflection": deflection, "hysteresis_position": position}

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return the resistance on the axis, N·m or N."""
        moved = signals["position"] - signals["hysteresis_position"]
        deflection = _deflected(signals["hysteresis_deflection"], moved, values["displacement"])
        return on_axis(constants, -values["level"] * deflection)


def _deflected(deflection: Tensor, way: Tensor, displacement: Tensor | float) -> Tensor:
    """Return the relative deflection after motion without reversal: dz = (1 − z·sign(way)) · way / displacement."""
    towards, left = _remainder(way, displacement)
    return towards + (deflection - towards) * left


def _remainder(way: Tensor, displacement: Tensor | float) -> tuple[Tensor, Tensor]:
    """Return the deflection that a displacement tends to, and the remaining fraction of the distance to it."""
    return torch.sign(way), torch.exp(-way.abs() / displacement)
