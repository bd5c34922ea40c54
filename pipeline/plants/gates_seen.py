"""Gates that a camera sees, which take the drift off the odometry of machines.

A machine measures its position from every gate in view. The noise of that is white, and its standard deviation is a
share of the distance. A Kalman filter for each machine believes that the drift of position is a random walk:

    p ← p + q dt,   k = p / (p + r),   d ← d − k (d + noise),   p ← (1 − k) p

with the drift d that is left, its variance p in the filter's eyes, and 1/r = Σ 1/r_gate over the gates in view. Without
a gate k is zero, and the drift grows. Velocity and attitude are left to the odometry.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from simgap.plants.rotation import Array

Look = Callable[[Array], Array]
"""From states (runs, 13) to the distances of the gates in view, (runs, gates) m, infinite where a gate is not."""

IMAGE = 0.04  # s from image to image: what the detector of Kaufmann et al. 2023 (Nature 620) needs
SHARE = 0.025  # of the distance, standard deviation along each axis: docs/perception.md, corners off by 1 px
_WANDERS = 0.05  # m²/s, q


class GatesSeen:
    """What the gates leave of the drift, all runs at once.

    Attributes:
        in_view: whether the last image showed a gate, (runs,) bool.
    """

    def __init__(self, look: Look, runs: int, random: np.random.Generator) -> None:
        """Begin without drift, and sure of it."""
        self._look, self._random = look, random
        self._variance = np.zeros((runs, 1))
        self.in_view: NDArray[np.bool_] = np.zeros(runs, dtype=bool)

    def corrected(self, drift: Array, state: Array) -> Array:
        """Return what is left of the drift after an image.

        Args:
            drift: of position, world frame, (runs, 3) m.
            state: position, velocity (world), attitude, body rate, (runs, 13).
        """
        distance = self._look(state)
        self.in_view = np.asarray(np.isfinite(distance).any(axis=-1))
        known = ((SHARE * distance) ** -2.0).sum(axis=-1, keepdims=True)  # 1/r, zero where no gate is seen
        self._variance += IMAGE * _WANDERS
        gain = self._variance * known / (1.0 + self._variance * known)
        self._variance *= 1.0 - gain
        noise = self._random.standard_normal(drift.shape) / np.sqrt(np.where(known > 0.0, known, np.inf))
        return drift - gain * (drift + noise)
