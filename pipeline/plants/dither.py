"""Excitation signal of identification flights, added to the path."""

from dataclasses import dataclass

import numpy as np

from simgap.plants.case import PlantCase
from simgap.plants.rotation import Array

_LINES = 8
_LOWEST_FREQUENCY, _HIGHEST_FREQUENCY = 1.2, 7.0  # Hz
_SIZES = np.array([0.8, 0.25, 0.25, 0.12])  # rms of thrust, m/s², and of the rates about x, y, z, rad/s


@dataclass(frozen=True)
class Dither:
    """A multisine per run on thrust and body rates.

    Attributes:
        amplitude: (runs, 4, lines).
        frequency: same shape, rad/s.
        phase: same shape, rad.
    """

    amplitude: Array
    frequency: Array
    phase: Array

    def at(self, time: float | Array) -> Array:
        """Return what is added to mass-normalised thrust, m/s², and body rates, rad/s, at times (...), s.

        Returns:
            (..., runs, 4).
        """
        argument = self.frequency * np.asarray(time, dtype=float)[..., None, None, None] + self.phase
        return (self.amplitude * np.sin(argument)).sum(axis=-1)


def shake(case: PlantCase, random: np.random.Generator) -> Dither:
    """Return a multisine with lines spread evenly over the octaves, drawn anew for each run and channel."""
    shape = (case.runs, 4, _LINES)
    octaves = np.linspace(np.log(_LOWEST_FREQUENCY), np.log(_HIGHEST_FREQUENCY), _LINES)
    spread = random.uniform(-0.5, 0.5, shape) * (octaves[1] - octaves[0])
    amplitude = case.excitation * _SIZES[:, None] * np.sqrt(2.0 / _LINES)
    return Dither(
        amplitude=np.broadcast_to(amplitude, shape),
        frequency=2.0 * np.pi * np.exp(octaves + spread),
        phase=random.uniform(0.0, 2.0 * np.pi, shape),
    )
