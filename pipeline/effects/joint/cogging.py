"""Torque ripple of a joint that repeats along its travel."""

import math

import torch

from simgap.effects.effect import Parameter, Signals, Values, WrenchEffect
from simgap.effects.joint.common import on_axis
from simgap.effects.sizes import size_of, sizes_of
from simgap.physics.shapes import Channels

_LEAST_CYCLES = 2  # per turn: a magnet has two poles, and one wave per turn is a gravity load
_MOST_CYCLES = 48
_FEW_WAVES = 8  # of the finest kind along the travel: below this, finer waves are tried
_PHASES = 3


def _slides(constants: Values | None) -> bool:
    """Whether the axis slides, so that no wave repeats with a turn."""
    return constants is not None and constants.get("channel") == "force"


class Cogging(WrenchEffect):
    """A torque ripple from magnets or gear teeth repeats along the position."""

    linear = False
    name = "cogging"
    kind = "joint"
    acts_on = "torque"
    parameters = (
        Parameter("sine", "N·m", 0.05, -1e6, 1e6),
        Parameter("cosine", "N·m", 0.02, -1e6, 1e6),
        Parameter("cycles", "1/rad", 12.0, float(_LEAST_CYCLES), 1e5, neutral=3.0),
    )
    needs = ("position",)
    formula = "torque = sine · sin(cycles · position) + cosine · cos(cycles · position)"
    source = "Hendershot & Miller 2010, Design of brushless permanent-magnet machines: cogging torque"
    sentence = (
        "A ripple of {sine} {sine_unit} (sine) and {cosine} {cosine_unit} (cosine) repeats along the travel "
        "at {cycles} {cycles_unit}; add cogging to the simulator."
    )
    excitation = "move at a slow constant speed over the whole travel, in both directions"
    symptom = "At slow constant speed the effort ripples at the same positions in both directions."
    look_alikes = ("constant_load", "gravity_load")

    def starts(self) -> list[dict[str, float]]:
        """Start from every whole number of cycles per turn, in several phases: each has a local minimum."""
        return self._scanned([float(cycles) for cycles in range(_LEAST_CYCLES, _MOST_CYCLES + 1)])

    def starts_in(self, signals: Signals, constants: Values | None = None) -> list[dict[str, float]]:
        """Start from every half wave along the travel if the axis slides, and finer ones too if it turns little."""
        position = signals["position"]
        travel = float(position.max() - position.min())
        size = size_of("N·m", sizes_of(self.kind, signals, constants or {}))
        whole = [] if _slides(constants) else [*range(_LEAST_CYCLES, _MOST_CYCLES + 1)]
        few = 0.0 < travel < _FEW_WAVES * 2.0 * math.pi / _MOST_CYCLES or not whole
        finest = max(whole, default=0)
        waves = (math.pi * halves / max(travel, 1e-30) for halves in range(1, 2 * _MOST_CYCLES + 1) if few)
        return self._scanned([*map(float, whole), *(cycles for cycles in waves if cycles > finest)], size)

    def parameters_in(self, signals: Signals, constants: Values | None = None) -> tuple[Parameter, ...]:
        """Return the parameters with the bounds for a recorded machine; cycles of a turn need no size."""
        sine, cosine, cycles = super().parameters_in(signals, constants)
        return sine, cosine, cycles if _slides(constants) else self.parameters[2]

    def _scanned(self, scan: list[float], size: float = 1.0) -> list[dict[str, float]]:
        amplitude = size * self.defaults()["sine"]
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
