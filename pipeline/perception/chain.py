"""The chain in the loop: the estimates of machines that fly, which are odometry less the drift that their cameras show.

An image is taken every `images.period`. What is found in it is known `detector.delay` later, and is compared with what
the odometry believed when it was taken.
"""

from collections import deque
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from simgap.gates.track import Track
from simgap.perception.correction import DriftCorrection
from simgap.perception.pose import Belief
from simgap.perception.settings import PerceptionSettings

Array = NDArray[Any]
See = Callable[[Array], list[Array]]
"""From states (machines, 13) to the corners of the gates that each finds in its image, (gates, 4, 2) px each."""


class Chain:
    """From the images of machines to their estimates, all machines at once.

    Attributes:
        in_view: whether the last image that was read gave a position which was believed, (machines,) bool.
        counts: of each machine so far, (machines,): `images` that were read, `gates_found` in them, `gates_believed`.
    """

    def __init__(
        self, see: See, settings: PerceptionSettings, track: Track, machines: int, step: float, seed: int
    ) -> None:
        """Begin without drift.

        Args:
            see: what is found in an image.
            settings: of camera, corners, drift, and of the times of image and detector.
            track: its gates.
            machines: how many.
            step: of the odometry, s.
            seed: of the perturbed corners.

        Raises:
            InputError: on a camera that cannot be.
        """
        seeds = np.random.SeedSequence(seed).generate_state(machines)
        self._corrections = [DriftCorrection(settings, track, int(each)) for each in seeds]
        self._see, self._step, self._steps = see, step, 0
        self._every = max(1, round(settings.images.period / step))
        self._delay = round(settings.detector.delay / step)
        self._unread = deque[tuple[int, list[Array], Array]]()
        self.in_view = np.zeros(machines, dtype=bool)
        self.counts: Mapping[str, NDArray[np.int_]] = {
            name: np.zeros(machines, dtype=int) for name in ("images", "gates_found", "gates_believed")
        }

    def corrected(self, states: Array, believed: Array) -> Array:
        """Go on by a step of the odometry, and return what is believed without its drift, (machines, 13).

        Args:
            states: true position, velocity (world), attitude, body rate, (machines, 13), of which images are taken.
            believed: the same as the odometry has it, with its drift.
        """
        for correction in self._corrections:
            correction.advance(self._step)
        if self._steps % self._every == 0:
            self._unread.append((self._steps + self._delay, self._see(states), believed.copy()))
        while self._unread and self._unread[0][0] <= self._steps:
            self._read(*self._unread.popleft()[1:])
        self._steps += 1
        left = believed.copy()
        for number, correction in enumerate(self._corrections):
            left[number, :3], left[number, 3:6] = correction.corrected(
                believed[number, :3], believed[number, 3:6]
            )
        return left

    def _read(self, found: list[Array], believed: Array) -> None:
        """Take in an image of each machine, and what its odometry believed when it was taken."""
        for number, (correction, corners) in enumerate(zip(self._corrections, found, strict=True)):
            odometry = Belief(believed[number, :3], believed[number, 6:10])
            taken = len(correction.see(corners, odometry))
            self.in_view[number] = taken > 0
            for name, count in zip(self.counts, (1, len(corners), taken), strict=True):
                self.counts[name][number] += count
