"""A compiled loop: the likeliest mixture of blocks with noise alone and of blocks with a discrepancy beside it.

The likelihoods are those of `simgap.equations.temper`.
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]

_MOST = 700.0
"""Of a logarithm of odds, beyond which its exponential overflows."""
_LEAST_MISSED = 1e-30
"""Of blocks: where none holds a discrepancy, its usual size is the least one."""


@njit(cache=True)
def likeliest(
    left: Array,
    beyond: Array,
    sound: Array,
    least: Array,
    lasting: float,
    tail: float,
    shares: Array,
    first: int,
    last: int,
) -> tuple[Array, Array]:
    """Return the likeliest share of blocks that hold a discrepancy, and its likeliest usual mean square.

    Args:
        left: mean square of the residual, (groups, blocks).
        beyond: log likelihood of what is left of the noise beside a discrepancy, (groups, blocks).
        sound: log likelihood with noise alone, (groups, blocks).
        least: usual mean square of a discrepancy, (groups,).
        lasting: independent samples of a discrepancy in a block.
        tail: degrees of freedom of its size.
        shares: among which the likeliest is chosen, (shares,).
        first: iterations for the usual size with each share.
        last: iterations with the chosen one.

    Returns:
        (groups,) each.
    """
    groups = left.shape[0]
    share, usual = np.empty(groups), np.empty(groups)
    for group in range(groups):
        rows = left[group], beyond[group], sound[group]
        start, best = math.exp(np.log(left[group]).mean()), -math.inf
        for each in shares:
            size = _settled(rows, each, start, least[group], lasting, tail, first)
            value = _value(rows, each, size, lasting, tail)
            if value > best:
                best, share[group], usual[group] = value, each, size
        usual[group] = _settled(rows, share[group], usual[group], least[group], lasting, tail, last)
    return share, usual


@njit(cache=True)
def _settled(
    rows: tuple[Array, Array, Array],
    share: float,
    usual: float,
    least: float,
    lasting: float,
    tail: float,
    times: int,
) -> float:
    """Return the usual mean square after some iterations of its fixed point."""
    left, beyond, sound = rows
    odds = math.log(share / (1.0 - share))
    for _ in range(times):
        weighted, missed = 0.0, 0.0
        level, slope = _size_of(usual, lasting, tail)
        for block in range(len(left)):
            above = tail * usual + left[block]
            against = sound[block] - beyond[block] - odds - level + slope * math.log(above)
            there = 1.0 / (1.0 + math.exp(min(against, _MOST)))
            weighted += there * left[block] / above
            missed += there
        usual = max((tail + 1.0) * usual * weighted / max(missed, _LEAST_MISSED), least)
    return usual


@njit(cache=True)
def _value(
    rows: tuple[Array, Array, Array], share: float, usual: float, lasting: float, tail: float
) -> float:
    """Return the log likelihood of all blocks."""
    left, beyond, sound = rows
    total = 0.0
    level, slope = _size_of(usual, lasting, tail)
    for block in range(len(left)):
        spoilt = math.log(share) + beyond[block] + level - slope * math.log(tail * usual + left[block])
        alone = math.log(1.0 - share) + sound[block]
        greater = max(spoilt, alone)
        total += greater + math.log1p(math.exp(min(spoilt, alone) - greater))
    return total


@njit(cache=True)
def _size_of(usual: float, lasting: float, tail: float) -> tuple[float, float]:
    """Return c and m of the log likelihood c − m·ln(ν·D + s²) of independent samples of a usual mean square D."""
    slope = 0.5 * lasting * (tail + 1.0)
    return slope * math.log((tail + 1.0) * usual) - 0.5 * lasting * math.log(usual), slope
