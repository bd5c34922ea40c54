"""The pilot's sticks: commands of body rates that change once a sample."""

import numpy as np

from simgap.plants.rig.case import RigCase
from simgap.plants.rotation import Array

_LINES = 6
_LOWEST_FREQUENCY, _HIGHEST_FREQUENCY = 0.05, 0.5  # Hz, of the attitude that the pilot keeps


class Sticks:
    """Commands of all runs; call it once a sample."""

    def __init__(self, case: RigCase, samples: int, random: np.random.Generator) -> None:
        """Draw what is wanted of each of `samples` samples."""
        shape = (case.runs, 3, _LINES)
        frequency = 2.0 * np.pi * random.uniform(_LOWEST_FREQUENCY, _HIGHEST_FREQUENCY, shape)
        phase = random.uniform(0.0, 2.0 * np.pi, shape)
        time = np.arange(samples)[:, None, None, None] / case.rate
        size = case.pilot.wander * np.sqrt(2.0 / _LINES)
        self.pilot = case.pilot
        self.wanted = size * np.sin(frequency * time + phase).sum(axis=-1)  # (samples, runs, 3) rad
        self.shaking = case.pilot.shaking * _pseudo_random(case, samples, random)

    def __call__(self, sample: int, rotation: Array) -> Array:
        """Return the commanded body rates (runs, 3), rad/s, at a sample.

        Args:
            sample: its number.
            rotation: body to world (runs, 3, 3).
        """
        off = self.wanted[sample] - _angles(rotation)
        off = (off + np.pi) % (2.0 * np.pi) - np.pi
        command = self.pilot.eagerness * off + self.shaking[sample]
        return np.clip(command, -self.pilot.most, self.pilot.most)


def _pseudo_random(case: RigCase, samples: int, random: np.random.Generator) -> Array:
    """Return steps of random size, −1 to 1, at random samples, (samples, runs, 3).

    A new value may follow on the next sample, so that they reach up to half the rate of the recording. Their sizes
    differ (Nelles 2001, "Nonlinear System Identification", §14.7.4), since what saturates answers each in its own way.
    """
    shape = (samples, case.runs, 3)
    level = random.uniform(-1.0, 1.0, shape)
    changes = random.random(shape) < 1.0 / max(case.pilot.hold * case.rate, 1.0)
    changes[0] = True
    last = np.maximum.accumulate(np.where(changes, np.arange(samples)[:, None, None], 0), axis=0)
    return np.take_along_axis(level, last, axis=0)


def _angles(rotation: Array) -> Array:
    """Return roll, pitch and yaw (runs, 3), rad."""
    roll = np.arctan2(rotation[:, 2, 1], rotation[:, 2, 2])
    pitch = -np.arcsin(np.clip(rotation[:, 2, 0], -1.0, 1.0))
    yaw = np.arctan2(rotation[:, 1, 0], rotation[:, 0, 0])
    return np.stack((roll, pitch, yaw), axis=-1)
