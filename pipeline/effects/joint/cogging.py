"""Torque of a joint that comes back along its travel."""

import math

import torch

from simgap.effects.effect import Parameter, Signals, Values, WrenchEffect
from simgap.effects.joint.common import on_axis
from simgap.physics.shapes import Channels

_LEAST_CYCLES = (
    2  # of a turn: a magnet has two poles, and one wave in a turn is a weight that hangs off the axis
)
_MOST_CYCLES = 48
_FEW_WAVES = 8  # of the finest of them along a travel that is short for it
_PHASES = 3


class Cogging(WrenchEffect):
    """Magnets that prefer some places, or teeth that come round: a wave along the position."""

    linear = False
    name = "cogging"
    kind = "joint"
    acts_on = "torque"
    parameters = (
        Parameter("sine", "N·m", 0.05, -1e4, 1e4),
        Parameter("cosine", "N·m", 0.02, -1e4, 1e4),
        Parameter("cycles", "1/rad", 12.0, float(_LEAST_CYCLES), 1e5, neutral=3.0),
    )
    needs = ("position",)
    yields_to = ("constant_load",)
    formula = "torque = sine · sin(cycles · position) + cosine · cos(cycles · position)"
    source = "Hendershot & Miller 2010, Design of brushless permanent-magnet machines: cogging torque"
    sentence = (
        "A ripple of {sine} {sine_unit} (sine) and {cosine} {cosine_unit} (cosine) repeats along the travel with "
        "{cycles} {cycles_unit}; add cogging."
    )
    excitation = "slow constant speed over the whole travel, in both directions"

    def starts(self) -> list[dict[str, float]]:
        """Start from every whole number of cycles per turn, in several phases: each number is a valley of its own."""
        return self._scanned([float(cycles) for cycles in range(_LEAST_CYCLES, _MOST_CYCLES + 1)])

    def starts_in(self, signals: Signals) -> list[dict[str, float]]:
        """Start on an axis of little travel, as one that slides, from finer waves, too: by halves along the travel."""
        position = signals["position"]
        travel = float(position.max() - position.min())
        if not 0.0 < travel < _FEW_WAVES * 2.0 * math.pi / _MOST_CYCLES:
            return self.starts()
        waves = (math.pi * halves / travel for halves in range(1, 2 * _MOST_CYCLES + 1))
        return self.starts() + self._scanned([cycles for cycles in waves if cycles > _MOST_CYCLES])

    def _scanned(self, scan: list[float]) -> list[dict[str, float]]:
        amplitude = self.defaults()["sine"]
        angles = [0.5 + 2.0 * math.pi * phase / _PHASES for phase in range(_PHASES)]
        return [
            {
                "sine": amplitude * math.cos(angle),
                "cosine": amplitude * math.sin(angle),
                "cycles": cycles,
            }
            for cycles in scan
            for angle in angles
        ]

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return the ripple on the axis, N·m or N."""
        angle = values["cycles"] * signals["position"]
        wave = values["sine"] * torch.sin(angle) + values["cosine"] * torch.cos(angle)
        return on_axis(constants, wave)
