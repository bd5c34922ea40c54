"""The drift of odometry, by a Kalman filter (Kaufmann et al. 2023, Nature 620, Methods, "VIO drift estimation").

The state is x = [p_d, v_d] ∈ ℝ⁶: by how much the odometry's position is off, m, and how fast that grows, m/s. From one
step to the next

    x ← F x,   P ← F P Fᵀ + Q,   F = [[I, dt I], [0, I]],   Q = diag(σ_pos I, σ_vel I)

and from a measured drift z = H x + noise of covariance R

    K = P Hᵀ (H P Hᵀ + R)⁻¹,   x ← x + K (z − H x),   P ← (I − K H) P

Drift and covariance are zero at the start. The measurements of all gates of one image are stacked: z has 3n numbers, H
is [I, 0] n times below one another, R has the n covariances as blocks.
"""

from typing import Any

import numpy as np
from filterpy.kalman import KalmanFilter
from numpy.typing import NDArray
from scipy.linalg import block_diag

from simgap.perception.settings import DriftSettings

Array = NDArray[Any]


class DriftFilter:
    """What is known of the drift, beginning with none."""

    def __init__(self, settings: DriftSettings) -> None:
        """Begin without drift, and sure of it."""
        self._filter = KalmanFilter(dim_x=6, dim_z=3)
        self._filter.P = np.zeros((6, 6))
        self._filter.Q = np.diag([settings.position] * 3 + [settings.velocity] * 3)

    @property
    def position(self) -> Array:
        """Drift of the position p_d, world frame, (3,) m."""
        return self._filter.x[:3, 0]

    @property
    def velocity(self) -> Array:
        """Drift of the velocity v_d, world frame, (3,) m/s."""
        return self._filter.x[3:, 0]

    @property
    def covariance(self) -> Array:
        """Covariance P of both, (6, 6)."""
        return self._filter.P

    def advance(self, period: float) -> None:
        """Go on by a step of the odometry.

        Args:
            period: dt, s.
        """
        transition = np.eye(6)
        transition[:3, 3:] = period * np.eye(3)
        self._filter.predict(F=transition)

    def correct(self, drifts: Array, covariances: Array) -> None:
        """Take in what the gates of one image say, in one update.

        Args:
            drifts: position of the odometry less that from a gate, (gates, 3) m.
            covariances: of each, (gates, 3, 3) m².
        """
        seen = np.tile(np.eye(3, 6), (len(drifts), 1))
        self._filter.update(drifts.reshape(-1, 1), R=block_diag(*covariances), H=seen)
