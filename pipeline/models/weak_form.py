"""Equations of motion without differentiated noise: averaged with smooth functions, integrated by parts.

For w(t) that vanishes at both ends of its window, ∫ w·(dq/dt) dt = −∫ (dw/dt)·q dt: the rate of q is had
without differentiating it. Source: Messenger & Bortz 2021, "Weak SINDy", SIAM Multiscale Modeling &
Simulation 19(3).
"""

from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

_LEAST_HALF = 4


@dataclass(frozen=True)
class WeakForm:
    """One test function (1 − s²)³ on the samples of a window.

    Attributes:
        weights: (window,); sums to one, so that it takes a mean.
        slopes: (window,), 1/s; applied to a quantity, it gives the weighted mean of its rate.
        stride: samples from one window to the next: half a window.
    """

    weights: np.ndarray
    slopes: np.ndarray
    stride: int

    @classmethod
    def of_width(cls, width: float, time_step: float) -> "WeakForm":
        """Return the test function of a width in s, of nine samples at least."""
        half = max(round(width / time_step / 2), _LEAST_HALF)
        offset = np.arange(-half, half + 1)
        inside = 1.0 - (offset / half) ** 2
        weights = inside**3 / np.sum(inside**3)
        slopes = -offset * inside**2
        # Scaled so that the rate of a straight line comes out exact on the sampled function.
        return cls(weights, slopes / np.sum(slopes * offset * time_step), half)

    def mean(self, series: np.ndarray) -> np.ndarray:
        """Return the weighted means (windows, ...) of a series (samples, ...)."""
        return self._apply(self.weights, series)

    def mean_rate(self, series: np.ndarray) -> np.ndarray:
        """Return the weighted means (windows, ...) of the rate of a series (samples, ...)."""
        return self._apply(self.slopes, series)

    def centres(self, series: np.ndarray) -> np.ndarray:
        """Return what belongs to the middle (windows,) of each window of a series (samples,)."""
        return series[self.stride : len(series) - self.stride : self.stride]

    def _apply(self, function: np.ndarray, series: np.ndarray) -> np.ndarray:
        if len(series) < len(function):
            return np.zeros((0, *series.shape[1:]))
        windows = sliding_window_view(series, len(function), axis=0)[:: self.stride]
        return windows @ function
