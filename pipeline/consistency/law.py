"""Laws of motion as redundancies: a drive against the motion that it makes, with the numbers of the platform.

The drive is regressed on the terms that the platform foretells, beside what friction, gravity, springs and loads could
add. A coefficient is the ratio of what the recording needs over what the platform says, and would be one for a perfect
platform file. What is plausible is a density of its logarithm: no platform number is wrong by a factor of a hundred,
but the factor of a unit is.
"""

from dataclasses import dataclass

import numpy as np

from simgap.consistency.redundancy import FLOOR, INDEPENDENT, Agreement

_COLOURED = 3.0  # times the standard error of white errors: what the law leaves out lasts for several windows
_EXACT = 0.15  # of a ratio: no law holds better
_UNKNOWN = 1e-4  # density that any ratio has: something may be at work that nobody thinks of
_CLEAR = 3.0  # odds of twenty to one
_FEWEST = 20  # windows
_LOGARITHMS = np.linspace(-4.0, 4.0, 801)


@dataclass(frozen=True)
class Ratio:
    """What a platform number may be off by.

    Attributes:
        spread: standard deviation of the logarithm of true over told.
        more: share of machines in which something else adds to it, such as viscous friction to the back-EMF.
    """

    spread: float
    more: float = 0.0

    @property
    def density(self) -> np.ndarray:
        """The density of the logarithm on a grid."""
        usual = _normal(_LOGARITHMS, self.spread)
        added = np.where(_LOGARITHMS > 0.0, 2.0 * _normal(_LOGARITHMS, 1.0), 0.0)
        return (1.0 - self.more) * usual + self.more * added

    def support(self, value: float, error: float) -> float:
        """Return the log likelihood of an estimate, zero for an exact one of 1; the unit of the drive cancels."""
        peak = self._likelihood(1.0, _EXACT)
        return float(np.log(max(self._likelihood(value, error), _UNKNOWN * peak) / peak))

    def _likelihood(self, value: float, error: float) -> float:
        width = float(np.hypot(error, _EXACT * value))
        if not width > 0.0:
            return 0.0
        near = np.exp(-0.5 * ((value - np.exp(_LOGARITHMS)) / width) ** 2) / width
        step = _LOGARITHMS[1] - _LOGARITHMS[0]
        return float((near * self.density).sum() * step * np.hypot(value, error))


@dataclass(frozen=True)
class Term:
    """A term of a law: what the platform foretells, (windows,), and how far off it may be."""

    foretold: np.ndarray
    ratio: Ratio


def law_agreement(
    name: str,
    columns: tuple[str, ...],
    drive: np.ndarray,
    terms: list[Term],
    others: np.ndarray,
    weight: float = 1.0,
) -> Agreement | None:
    """Compare a drive with the motion.

    Args:
        name: of what is compared.
        columns: that are at stake; the first one is named.
        drive: recorded, (windows,).
        terms: of the law.
        others: what else may be at work, (windows, columns).
        weight: of the evidence, below one where the same is asked of several motors.

    Returns:
        None where there are too few windows, or the drive never changes.
    """
    columns_of = np.concatenate([np.stack([term.foretold for term in terms], axis=-1), others], axis=-1)
    known = np.isfinite(columns_of).all(axis=1) & np.isfinite(drive)
    motion, recorded = columns_of[known], drive[known]
    if len(recorded) < max(_FEWEST, 2 * motion.shape[1]) or not np.ptp(recorded) > 0.0:
        return None
    ratios, errors, left = _regressed(motion, recorded)
    supports = [
        term.ratio.support(ratio, error) for term, ratio, error in zip(terms, ratios, errors, strict=False)
    ]
    count = min(INDEPENDENT, 0.5 * len(recorded))
    support = sum(supports) - 0.5 * count * float(np.log((left + FLOOR) / (1.0 + FLOOR)))
    figures = "it needs " + " and ".join(f"{ratio:.3g}" for ratio in ratios[: len(terms)])
    return Agreement(
        name,
        columns,
        weight * support,
        bool(min(supports) < -_CLEAR or left > 0.5),
        f"{figures} times what the platform file foretells",
        float(ratios[0]),
    )


def _regressed(motion: np.ndarray, drive: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
    """Return coefficients, their errors and the share of the drive's energy that is left."""
    size = np.sqrt(np.mean(motion**2, axis=0))
    size[size == 0.0] = np.inf
    scaled = motion / size
    found = np.linalg.lstsq(scaled, drive, rcond=1e-6)[0]
    rest = drive - scaled @ found
    normal = np.linalg.pinv(scaled.T @ scaled, rcond=1e-10, hermitian=True)
    errors = _COLOURED * np.sqrt(np.maximum(np.diag(normal), 0.0) * np.mean(rest**2))
    finite = np.where(np.isfinite(size), size, 1.0)
    dead = ~np.isfinite(size)
    values, spreads = found / finite, errors / finite
    spreads[dead] = np.inf
    return values, spreads, float(np.mean(rest**2) / max(np.mean(drive**2), 1e-300))


def _normal(values: np.ndarray, spread: float) -> np.ndarray:
    return np.exp(-0.5 * (values / spread) ** 2) / (spread * np.sqrt(2.0 * np.pi))
