"""Odometry whose drift is taken off by the gates that the camera sees (Kaufmann et al. 2023, Nature 620, Methods)."""

from dataclasses import replace

import numpy as np
import torch

from simgap.gates.track import Track
from simgap.perception.camera import camera_from
from simgap.perception.drift import DriftFilter
from simgap.perception.pose import Array, Belief, Fix, fixes_from
from simgap.perception.settings import PerceptionSettings


class DriftCorrection:
    """The estimate of one machine: odometry less drift.

    Orientation is left to the odometry. The corners of an image are taken as seen now, although a detector needs time.
    """

    def __init__(self, settings: PerceptionSettings, track: Track, seed: int) -> None:
        """Begin without drift.

        Args:
            settings: of camera, corners and drift.
            track: its gates.
            seed: of the perturbed corners.

        Raises:
            InputError: on a camera that cannot be.
        """
        self._camera = camera_from(settings.camera)
        self._track, self._corners = track.to(torch.float64), settings.corners
        self._random = np.random.default_rng(seed)
        self.drift = DriftFilter(settings.drift)

    def advance(self, period: float) -> None:
        """Go on by a step of the odometry, s."""
        self.drift.advance(period)

    def see(self, corners: Array, odometry: Belief) -> list[Fix]:
        """Take in an image, and return the positions from its gates that were believed.

        Args:
            corners: of each gate that is wholly in it, clockwise as the image shows them, from any of them,
                (gates, 4, 2) px.
            odometry: of the same moment, with its drift.
        """
        belief = replace(odometry, position=odometry.position - self.drift.position)
        fixes = fixes_from(self._camera, self._track, corners, belief, self._corners, self._random)
        drifts = np.array([odometry.position - fix.position for fix in fixes]).reshape(-1, 3)
        covariances = np.array([fix.covariance for fix in fixes]).reshape(-1, 3, 3)
        return [fixes[number] for number in self.drift.correct(drifts, covariances)]

    def corrected(self, position: Array, velocity: Array) -> tuple[Array, Array]:
        """Return position (3,) m and velocity (3,) m/s of the odometry, world frame, without their drift."""
        return position - self.drift.position, velocity - self.drift.velocity
