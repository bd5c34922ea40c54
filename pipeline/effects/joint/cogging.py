"""Torque ripple of a joint that repeats along its travel."""

import math

import torch

from simgap.effects.effect import Parameter, Signals, Values, WrenchEffect
from simgap.effects.joint.common import on_axis
from simgap.physics.shapes import Channels

_LEAST_CYCLES = 2  # per turn: a magnet has two poles, and one wave per turn is a gravity load
_MOST_CYCLES = 48
_FEW_WAVES = 8  # of the finest kind along the travel: below this, finer waves are tried
_PHASES = 3


class Cogging(WrenchEffect):
    """A torque ripple from magnets or gear teeth repeats along the position."""

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
        "A ripple of {sine} {sine_unit} (sine) and {cosine} {cosine_unit} (cosine) repeats along the travel "
        "at {cycles} {cycles_unit}; add cogging to the simulator."
    )
    excitation = "move at a slow constant speed over the whole travel, in both directions"
    symptom = "At slow constant speed the effort ripples at the same positions in both directions."
    look_alikes = ("gravity_load",)

    def starts(self) -> list[dict[str, float]]:
        """Start from every whole number of cycles per turn, in several phases: each has a local minimum."""
        return self._scanned([float(cycles) for cycles in range(_LEAST_CYCLES, _MOST_CYCLES + 1)])

    def starts_in(self, signals: Signals) -> list[dict[str, float]]:
        """Start from finer waves too if the axis has little travel: every half wave along the travel."""
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
