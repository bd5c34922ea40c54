"""Redundancies: what a recording says twice. How well both agree is the logarithm of a likelihood.

A redundancy compares a recorded series with one that follows from other columns, window by window. Only windows with
motion count, and each counts alike: e = |r − p|² / ½(|r|² + |p|²) is 0 where both agree, 2 where one of them is far
too small or both are unrelated, 4 where they are opposite. Its mean D over the windows is the misfit. As e is bounded,
a part of the windows may be spoilt; as it is a ratio, a change of the unit of both sides changes nothing. With a
Gaussian error of unknown size the log likelihood is −½·n·ln D, up to a constant.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

INDEPENDENT = 20
"""Most independent windows of a comparison: what disagrees in the same way all the time says so only once."""

FLOOR = 0.05
"""Least misfit that counts: sensors lag and are filtered, so no two series agree to better than a fifth."""

OPPOSED = 0.2
"""Misfit from which on two series do not say the same, at whatever lag: as if a tenth of one were spoilt."""

CLEAR = 1.0
"""Misfit that no filter makes: only then two faults at once are looked for."""

LAGS = (0, -1, 1, -2, 2)
"""Lags that are tried, in half windows: up to 0.1 s lies between a command and what it does, or in a filter."""

LAG_COST = 1.0
"""Log likelihood that a half window of lag costs."""

UNRELATED = 2.0
"""Misfit of two series that have nothing to do with each other."""

_MOVING = 0.05  # of the energy of the strongest windows: a window with less is at rest
_FEWEST = 5  # windows with motion
_DISTURBED = 25.0  # times the noise energy, from which on a window moves


@dataclass(frozen=True)
class Pair:
    """A recorded series and what follows from other columns.

    Attributes:
        name: of what is compared, in words.
        columns: that the recorded series was made of; the first one is named.
        recorded: (windows,).
        derived: (windows,).
        least: what noise makes of either, and the size below which a difference says nothing, in the unit of both.
        doubted: misfit from which on they are opposed; less where only exchanges of alike columns are at stake.
    """

    name: str
    columns: tuple[str, ...]
    recorded: np.ndarray
    derived: np.ndarray
    least: float = 0.0
    doubted: float = OPPOSED


@dataclass(frozen=True)
class Agreement:
    """How well what a recording says twice agrees.

    Attributes:
        name: of what is compared, in words.
        columns: that are at stake; the first one is named.
        support: log likelihood, 0 for two unrelated series.
        opposed: whether both clearly say different things.
        figures: how they differ, in words.
        ratio: size of the recorded over that of the derived series.
        alike: correlation of both; NaN for a law.
        clear: whether no single physical effect explains it: only then two faults at once are looked for.
    """

    name: str
    columns: tuple[str, ...]
    support: float
    opposed: bool
    figures: str
    ratio: float = np.nan
    alike: float = np.nan
    clear: bool = True

    @property
    def is_exact(self) -> bool:
        """Whether two series are compared that have to agree, whatever physics is at work."""
        return not np.isnan(self.alike)

    @property
    def evidence(self) -> str:
        """What contradicts what, with figures."""
        return f"{self.name}: {self.figures}"


def agreement_of(pair: Pair) -> Agreement | None:
    """Compare two series; see the module. None where nothing moved."""

    def compared(lag: int) -> Agreement | None:
        return _compared(pair, *shifted(pair.recorded, pair.derived, lag), LAG_COST * abs(lag))

    return at_best_lag(compared)


def at_best_lag(compared: Callable[[int], Agreement | None]) -> Agreement | None:
    """Return the comparison at the likeliest lag.

    Every lag is tried, also where both sides agree without one: else a recording would be credited with a better lag
    only as long as nothing is undone.

    Args:
        compared: gives the comparison at a lag, in windows; None where there is nothing to compare.
    """
    found = (compared(lag) for lag in LAGS)
    return max((each for each in found if each is not None), key=lambda each: each.support, default=None)


def shifted(first: np.ndarray, second: np.ndarray, lag: int) -> tuple[np.ndarray, np.ndarray]:
    """Return two series with the first taken that many windows later."""
    if lag == 0:
        return first, second
    return (first[lag:], second[:-lag]) if lag > 0 else (first[:lag], second[-lag:])


def _compared(pair: Pair, recorded: np.ndarray, derived: np.ndarray, cost: float) -> Agreement | None:
    known = np.isfinite(recorded) & np.isfinite(derived)
    recorded, derived = recorded[known], derived[known]
    size = 0.5 * (recorded**2 + derived**2)
    strongest = float(np.quantile(size, 0.95)) if len(size) else 0.0
    moving = size > max(_MOVING * strongest, _DISTURBED * pair.least**2)
    if moving.sum() < _FEWEST or strongest == 0.0:
        return None
    recorded, derived, size = recorded[moving], derived[moving], size[moving]
    misfit = float(np.mean((recorded - derived) ** 2 / size))
    count = min(INDEPENDENT, 0.5 * float(moving.sum()))
    support = -0.5 * count * float(np.log((misfit + FLOOR) / (UNRELATED + FLOOR))) - cost
    alike = _correlation(recorded, derived)
    ratio = float(np.mean(np.abs(recorded)) / max(np.mean(np.abs(derived)), 1e-300))
    figures = f"{ratio:.3g} times as large, correlation {alike:.2f}"
    return Agreement(
        pair.name, pair.columns, support, misfit > pair.doubted, figures, ratio, alike, misfit > CLEAR
    )


def _correlation(recorded: np.ndarray, derived: np.ndarray) -> float:
    """Return the correlation about zero, in which no window counts more than ten times the usual one."""
    sides = [side / max(float(np.median(np.abs(side))), 1e-300) for side in (recorded, derived)]
    first, second = (np.clip(side, -np.sqrt(10.0), np.sqrt(10.0)) for side in sides)
    return float((first * second).sum() / np.sqrt(max((first**2).sum() * (second**2).sum(), 1e-300)))
