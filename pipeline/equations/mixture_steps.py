"""A compiled loop: the likeliest mixture of blocks with noise alone and of blocks with a discrepancy beside it.

The likelihoods are those of `simgap.equations.temper`.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]

_MOST = 700.0
"""Of a logarithm of odds, beyond which its exponential overflows."""
_LEAST = 1e-300
"""Of a sum: where no block holds a discrepancy, there is nothing to divide by."""


class _Rows(NamedTuple):
    """The blocks of one channel, over their noise.

    Attributes:
        seen: mean square of what is found of a sample of a discrepancy, (blocks,).
        noise: what noise alone makes of it, (blocks,).
        repeats: rows of a sample over the mean square of the noise, (blocks,).
        alone: log likelihood of noise alone, (blocks,).
    """

    seen: Array
    noise: Array
    repeats: Array
    alone: Array


class _Law(NamedTuple):
    """What is assumed of a discrepancy: share of blocks, samples in each of them, its tail and what that costs."""

    share: float
    samples: float
    tail: float
    spread: float


@njit(cache=True)
def likeliest(
    left: Array,
    noise: Array,
    independent: Array,
    chance: Array,
    shares: Array,
    samples: Array,
    costs: Array,
    tail: float,
    spread: float,
    first: int,
    last: int,
) -> tuple[Array, Array]:
    """Return the likeliest share of blocks that hold a discrepancy, and its likeliest usual mean square.

    Args:
        left: mean square of the residual, at least the noise's, (groups, blocks).
        noise: mean square of the noise, (groups, blocks).
        independent: rows, (groups, blocks).
        chance: what noise alone costs a block on average, (groups, blocks).
        shares: among which the likeliest is chosen, (shares,).
        samples: independent samples of a discrepancy in a block that holds one, for each share, (shares,).
        costs: of each share by its prior, (shares,).
        tail: degrees of freedom of a discrepancy's size.
        spread: what these cost a sample.
        first: iterations for the usual size with each share.
        last: iterations with the chosen one.

    Returns:
        (groups,) each.
    """
    groups = left.shape[0]
    share, usual = np.empty(groups), np.empty(groups)
    for group in range(groups):
        alone = chance[group] - 0.5 * independent[group] * (left[group] / noise[group] - 1.0)
        start, best, chosen = math.exp(np.log(left[group]).mean()), -math.inf, 0
        for each in range(len(shares)):
            law = _Law(shares[each], samples[each], tail, spread)
            rows = _rows_of(left[group], noise[group], independent[group], alone, law.samples)
            size = _settled(rows, law, start, first)
            value = _value(rows, law, size) - costs[each]
            if value > best:
                best, chosen, usual[group] = value, each, size
        share[group] = shares[chosen]
        law = _Law(shares[chosen], samples[chosen], tail, spread)
        rows = _rows_of(left[group], noise[group], independent[group], alone, law.samples)
        usual[group] = _settled(rows, law, usual[group], last)
    return share, usual


@njit(cache=True)
def _rows_of(left: Array, noise: Array, independent: Array, alone: Array, samples: float) -> _Rows:
    """Return the blocks of a channel with so many samples of a discrepancy in each block that holds one."""
    repeats = independent / samples
    seen = 1.0 + repeats * (left / noise - 1.0)
    return _Rows(seen, 1.0 + repeats * np.sqrt(2.0 / independent), repeats / noise, alone)


@njit(cache=True)
def _settled(rows: _Rows, law: _Law, usual: float, times: int) -> float:
    """Return the usual mean square after some iterations of its fixed point (Kent, Tyler & Vardi 1994)."""
    odds = math.log(law.share / (1.0 - law.share))
    for _ in range(times):
        found, counted = _LEAST, _LEAST
        for block in range(len(rows.seen)):
            seen, repeats = rows.seen[block], rows.repeats[block]
            expected = rows.noise[block] + repeats * usual
            against = rows.alone[block] - _beside(seen, expected, law) - odds
            there = repeats / (1.0 + math.exp(min(against, _MOST))) / (law.tail * expected + seen)
            found += there * seen / expected
            counted += there
        usual *= found / counted
    return usual


@njit(cache=True)
def _value(rows: _Rows, law: _Law, usual: float) -> float:
    """Return the log likelihood of all blocks."""
    total = 0.0
    for block in range(len(rows.seen)):
        expected = rows.noise[block] + rows.repeats[block] * usual
        spoilt = math.log(law.share) + _beside(rows.seen[block], expected, law)
        alone = math.log(1.0 - law.share) + rows.alone[block]
        greater = max(spoilt, alone)
        total += greater + math.log1p(math.exp(min(spoilt, alone) - greater))
    return total


@njit(cache=True)
def _beside(seen: float, expected: float, law: _Law) -> float:
    """Return the log likelihood of a block with a discrepancy, of an expected mean square with the noise."""
    above = math.log1p((seen / expected - 1.0) / (law.tail + 1.0))
    return -0.5 * law.samples * (math.log(expected) + (law.tail + 1.0) * above + law.spread)
