"""Laws of motion as redundancies: a drive against the motion that it makes, with the numbers of the platform.

The drive is regressed on the terms that the platform foretells, beside what friction, gravity, springs and loads could
add. A coefficient is the ratio of what the recording needs over what the platform says, and would be one for a perfect
platform file. What is plausible is a density of its logarithm: no platform number is wrong by a factor of a hundred,
but the factor of a unit is.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from simgap.consistency.redundancy import FLOOR, INDEPENDENT, LAG_COST, LAGS, Agreement, shifted

_COLOURED = 3.0  # times the standard error of white errors: what the law leaves out lasts for several windows
_EXACT = 0.15  # of a ratio: no law holds better
_UNKNOWN = 1e-4  # density that any ratio has: something may be at work that nobody thinks of
_DOUBTED, _CLEAR = (
    1.0,
    6.0,
)  # log likelihood below which a law is doubted, and two faults at once are looked for
_DISTURBED = 5.0  # times its noise, from which on a term says something
_LEAST_EXPLAINED = 0.02  # share; with less, anything fits
_MUCH = 0.5  # share of the drive's energy that is left
_FEWEST = 20  # windows
_SLOPES = np.linspace(0.0, 1.0, 3)  # of the way between both regressions
_LOGARITHMS = np.linspace(-4.0, 4.0, 401)


@dataclass(frozen=True)
class Estimate:
    """A coefficient: its value, its error, and the share of variance that it explains beside the others."""

    value: float
    error: float
    explained: float


@dataclass(frozen=True)
class Ratio:
    """What a platform number may be off by.

    Attributes:
        spread: standard deviation of the logarithm of true over told.
        more: share of machines in which something else adds to it, such as viscous friction to the back-EMF.
    """

    spread: float
    more: float = 0.0

    @cached_property
    def density(self) -> np.ndarray:
        """The density of the logarithm on a grid."""
        usual = _normal(_LOGARITHMS, self.spread)
        added = np.where(_LOGARITHMS > 0.0, 2.0 * _normal(_LOGARITHMS, 1.0), 0.0)
        return (1.0 - self.more) * usual + self.more * added

    def best_support(self, estimate: Estimate) -> float:
        """Return the log likelihood of a coefficient that noise in its term may have made too small.

        With noise in both, the true slope lies between that of one side on the other and its reverse, which is one
        over the explained share times as large [Fuller 1987].
        """
        steps = _SLOPES * -np.log(max(estimate.explained, _LEAST_EXPLAINED))
        return max(
            self.support(estimate.value * np.exp(step), estimate.error * np.exp(step)) for step in steps
        )

    def support(self, value: float, error: float) -> float:
        """Return the log likelihood of an estimate, zero for an exact one of 1; the unit of the drive cancels."""
        return float(np.log(max(self._likelihood(value, error), _UNKNOWN * self._peak) / self._peak))

    @cached_property
    def _peak(self) -> float:
        return self._likelihood(1.0, _EXACT)

    def _likelihood(self, value: float, error: float) -> float:
        width = float(np.hypot(error, _EXACT * value))
        if not width > 0.0:
            return 0.0
        near = np.exp(-0.5 * ((value - np.exp(_LOGARITHMS)) / width) ** 2) / width
        step = _LOGARITHMS[1] - _LOGARITHMS[0]
        return float((near * self.density).sum() * step * np.hypot(value, error))


@dataclass(frozen=True)
class Term:
    """A term of a law.

    Attributes:
        foretold: by the platform, (windows,).
        ratio: how far off it may be.
        noise: what sensor noise makes of it, standard deviation.
        exact: whether it has so little noise that its coefficient is not attenuated.
    """

    foretold: np.ndarray
    ratio: Ratio
    noise: float = 0.0
    exact: bool = False


def law_agreement(
    name: str,
    columns: tuple[str, ...],
    drive: np.ndarray,
    terms: list[Term],
    others: np.ndarray,
    weight: float = 1.0,
    fits: bool = True,
) -> Agreement | None:
    """Compare a drive with the motion.

    Args:
        name: of what is compared.
        columns: that are at stake; the first one is named.
        drive: recorded, (windows,).
        terms: of the law.
        others: what else may be at work, (windows, columns).
        weight: of the evidence, below one where the same is asked of several motors.
        fits: whether a drive that the motion does not explain at all is a contradiction.

    Returns:
        None where there are too few windows, or the drive never changes.
    """
    motion = _motion(terms, others)
    at_lags = (
        _compared(name, columns, *shifted(drive, motion, lag), terms, LAG_COST * abs(lag), weight, fits)
        for lag in LAGS
    )
    tried = [found for found in at_lags if found is not None]
    if not tried:
        return None
    likeliest, _ = max(tried, key=lambda found: found[0].support)
    # At another lag a wrong sign may look plausible, where the motion explains the drive far worse.
    closest, _ = min(tried, key=lambda found: found[1])
    return replace(likeliest, opposed=likeliest.opposed or closest.opposed)


def estimates_of(
    drive: np.ndarray, terms: list[Term], others: np.ndarray
) -> tuple[list[Estimate], float] | None:
    """Return the coefficients of the terms at the lag that leaves least, and the share of the drive's energy left.

    Arguments are as of `law_agreement`. None where there are too few windows, or the drive never changes.
    """
    motion = _motion(terms, others)
    found = []
    for lag in LAGS:
        told, moved = _known(*shifted(drive, motion, lag))
        if _tells(told, moved):
            found.append(_regressed(moved, told, len(terms)))
    return min(found, key=lambda each: each[1], default=None)


def _motion(terms: list[Term], others: np.ndarray) -> np.ndarray:
    return np.concatenate([np.stack([term.foretold for term in terms], axis=-1), others], axis=-1)


def _known(drive: np.ndarray, motion: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    known = np.isfinite(motion).all(axis=1) & np.isfinite(drive)
    return drive[known], motion[known]


def _tells(drive: np.ndarray, motion: np.ndarray) -> bool:
    return len(drive) >= max(_FEWEST, 2 * motion.shape[1]) and bool(np.ptp(drive) > 0.0)


def _compared(
    name: str,
    columns: tuple[str, ...],
    drive: np.ndarray,
    motion: np.ndarray,
    terms: list[Term],
    cost: float,
    weight: float,
    fits: bool,
) -> tuple[Agreement, float] | None:
    """Return the agreement at one lag, and the share of the drive's energy that is left."""
    drive, motion = _known(drive, motion)
    if not _tells(drive, motion):
        return None
    moves = [np.std(column) > _DISTURBED * term.noise for term, column in zip(terms, motion.T, strict=False)]
    if not any(moves):
        return None
    estimates, left = _regressed(motion, drive, len(terms))
    supports = [
        _supported(term, estimate) if moving else 0.0
        for term, estimate, moving in zip(terms, estimates, moves, strict=True)
    ]
    count = min(INDEPENDENT, 0.5 * len(drive))
    fit = -0.5 * count * float(np.log((left + FLOOR) / (1.0 + FLOOR)))
    figures = " and ".join(f"{estimate.value:.3g}" for estimate in estimates)
    agreement = Agreement(
        name,
        columns,
        weight * (sum(supports) + fit - cost),
        bool(sum(supports) < -_DOUBTED or (fits and left > _MUCH)),
        f"{figures} times as much as the platform file foretells",
        estimates[0].value,
        clear=bool(sum(supports) < -_CLEAR),
    )
    return agreement, left


def _supported(term: Term, estimate: Estimate) -> float:
    if term.exact:
        return term.ratio.support(estimate.value, estimate.error)
    return term.ratio.best_support(estimate)


def _regressed(motion: np.ndarray, drive: np.ndarray, count: int) -> tuple[list[Estimate], float]:
    """Return the first coefficients, and the share of the drive's energy that is left."""
    size = np.sqrt(np.mean(motion**2, axis=0))
    dead = size == 0.0
    scaled = motion / np.where(dead, 1.0, size)
    normal = np.linalg.pinv(scaled.T @ scaled, rcond=1e-10, hermitian=True)
    found = normal @ (scaled.T @ drive)
    rest = float(np.mean((drive - scaled @ found) ** 2))
    spread = np.sqrt(np.maximum(np.diag(normal), 1e-300) * rest)
    with np.errstate(divide="ignore", invalid="ignore"):
        certain = (found / spread) ** 2
    shown = np.clip(certain / (certain + len(drive)), 0.0, 1.0)  # squared partial correlation
    return [
        Estimate(
            float(found[place] / (size[place] or 1.0)),
            float(_COLOURED * spread[place] / size[place]) if not dead[place] else np.inf,
            float(np.nan_to_num(shown[place], nan=1.0)),
        )
        for place in range(count)
    ], rest / max(float(np.mean(drive**2)), 1e-300)


def _normal(values: np.ndarray, spread: float) -> np.ndarray:
    return np.exp(-0.5 * (values / spread) ** 2) / (spread * np.sqrt(2.0 * np.pi))
