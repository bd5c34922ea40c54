"""How residuals are distributed: their histogram and a kernel estimate of their density."""

from dataclasses import dataclass

import numpy as np
from scipy.stats import gaussian_kde

_BINS, _POINTS = 60, 121
_TAIL = 0.001  # share of the residuals beyond each end of the range, before it is widened
_MARGIN = 0.1  # by which the range is widened on both sides, of its width
_MOST = 5000  # residuals behind a kernel estimate: more only cost time
_LEAST_SPREAD = 1e-9  # of values, which have no histogram finer than that, and of a density over its range


@dataclass(frozen=True)
class ResidualDensity:
    """The distribution of some residuals over a range. Heights and densities are in the inverse of their unit.

    Attributes:
        edges: of the bins, (bins + 1,), in the residuals' unit.
        heights: of the bins, (bins,); height times width is the share of all residuals in a bin.
        grid: where the density is estimated, (points,), from the first edge to the last.
        density: (points,); empty where the residuals do not vary.
        uncorrected: density of the residuals before a bias correction, (points,); empty where there is none.
        samples: number of the residuals.
        outside: number of those outside the range or not finite.
        mean: of the finite ones, in their unit.
        std: standard deviation of the finite ones, in their unit.
    """

    edges: np.ndarray
    heights: np.ndarray
    grid: np.ndarray
    density: np.ndarray
    uncorrected: np.ndarray
    samples: int
    outside: int
    mean: float
    std: float

    @classmethod
    def of(cls, residuals: np.ndarray, uncorrected: np.ndarray | None = None) -> "ResidualDensity | None":
        """Describe residuals (samples,), and those before a bias correction; None where none is finite.

        The range leaves out a thousandth at each end, so that few great residuals do not hide all others.
        """
        finite = residuals[np.isfinite(residuals)]
        before = np.zeros(0) if uncorrected is None else uncorrected[np.isfinite(uncorrected)]
        if not len(finite):
            return None
        low, high = _range(np.concatenate([finite, before]))
        counts, edges = np.histogram(finite, _BINS, (low, high))
        grid = np.linspace(low, high, _POINTS)
        return cls(
            edges=edges,
            heights=counts / (len(residuals) * np.diff(edges)),
            grid=grid,
            density=_density(residuals, grid),
            uncorrected=np.zeros(0) if uncorrected is None else _density(uncorrected, grid),
            samples=len(residuals),
            outside=len(residuals) - int(counts.sum()),
            mean=float(finite.mean()),
            std=float(finite.std()),
        )


def _range(values: np.ndarray) -> tuple[float, float]:
    low, high = np.quantile(values, [_TAIL, 1.0 - _TAIL])
    margin = max(_MARGIN * (high - low), _LEAST_SPREAD * max(abs(low), abs(high))) or 1.0
    return float(low - margin), float(high + margin)


def _density(values: np.ndarray, grid: np.ndarray) -> np.ndarray:
    """Return the density of the values (samples,) on a grid (points,), empty where they hardly vary.

    Gaussian kernels as wide as Scott's rule says (Scott 1992, Multivariate Density Estimation, equation 6.42). The
    values beyond the grid have no kernel, because few great ones would widen all of them.
    """
    width = grid[-1] - grid[0]
    inside = (values[(values >= grid[0]) & (values <= grid[-1])] - grid[0]) / width
    if len(inside) < 2 or inside.std() < _LEAST_SPREAD:
        return np.zeros(0)
    chosen = inside[np.linspace(0, len(inside) - 1, min(len(inside), _MOST)).round().astype(int)]
    share = len(inside) / len(values)
    return share / width * gaussian_kde(chosen)((grid - grid[0]) / width)
