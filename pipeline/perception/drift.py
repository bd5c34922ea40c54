"""The drift of odometry, by a Kalman filter (Kaufmann et al. 2023, Nature 620, Methods, "VIO drift estimation").

The state is x = [p_d, v_d] ∈ ℝ⁶: by how much the odometry's position is off, m, and how fast that grows, m/s. From one
step to the next

    x ← F x,   P ← F P Fᵀ + Q,   F = [[I, dt I], [0, I]],   Q = diag(σ_pos I, σ_vel I)

and from a measured drift z = H x + noise of covariance R

    K = P Hᵀ (H P Hᵀ + R)⁻¹,   x ← x + K (z − H x),   P ← (I − K H) P

The gates of one image have independent noise, so they are taken in one after the other, which comes to the same as one
update of all of them. The next one is always that with the least normalised innovation squared

    (z − H x)ᵀ (H P Hᵀ + R)⁻¹ (z − H x)

and no more are taken once this is above the quantile of χ² with three degrees of freedom that a right measurement stays
below with a given probability (Bar-Shalom, Li & Kirubarajan 2001, Estimation with applications to tracking and
navigation, 5.4). Process noise is large from image to image. What is left of it after the first gates of an image is
small, and finds out those that are not there.

Drift and covariance are zero at the start.
"""

from typing import Any

import numpy as np
from filterpy.kalman import KalmanFilter
from numpy.typing import NDArray
from scipy.stats import chi2

from simgap.perception.settings import DriftSettings

Array = NDArray[Any]

_SEEN = np.eye(3, 6)  # H


class DriftFilter:
    """What is known of the drift, beginning with none."""

    def __init__(self, settings: DriftSettings) -> None:
        """Begin without drift, and sure of it."""
        self._filter = KalmanFilter(dim_x=6, dim_z=3)
        self._filter.P = np.zeros((6, 6))
        self._filter.Q = np.diag([settings.position] * 3 + [settings.velocity] * 3)
        self._most = float(chi2.ppf(settings.taken, 3))

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

    def correct(self, drifts: Array, covariances: Array) -> list[int]:
        """Take in what the gates of one image say, and return the numbers of those that were believed.

        Args:
            drifts: position of the odometry less that from a gate, (gates, 3) m.
            covariances: of each, (gates, 3, 3) m².
        """
        taken: list[int] = []
        while len(taken) < len(drifts):
            squared = self._innovations(drifts, covariances)
            squared[taken] = np.inf
            best = int(squared.argmin())
            if squared[best] > self._most:
                break
            self._filter.update(drifts[best, :, None], R=covariances[best], H=_SEEN)
            taken.append(best)
        return taken

    def _innovations(self, drifts: Array, covariances: Array) -> Array:
        """Return the normalised innovation squared of each measurement, (gates,)."""
        innovations = drifts - self.position
        spread = np.linalg.inv(self.covariance[:3, :3] + covariances)
        return np.einsum("gi,gij,gj->g", innovations, spread, innovations)
