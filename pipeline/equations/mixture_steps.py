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
_LEAST = 1e-300
"""Of a sum: where no block holds a discrepancy, there is nothing to divide by."""


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
            rows = _samples_of(left[group], noise[group], independent[group], alone, samples[each])
            size = _settled(rows, shares[each], start, samples[each], tail, spread, first)
            value = _value(rows, shares[each], size, samples[each], tail, spread) - costs[each]
            if value > best:
                best, chosen, usual[group] = value, each, size
        share[group] = shares[chosen]
        rows = _samples_of(left[group], noise[group], independent[group], alone, samples[chosen])
        usual[group] = _settled(rows, share[group], usual[group], samples[chosen], tail, spread, last)
    return share, usual


@njit(cache=True)
def _samples_of(
    left: Array, noise: Array, independent: Array, alone: Array, samples: float
) -> tuple[Array, Array, Array, Array]:
    """Return what is found of a sample, what noise alone makes of it, and its rows, over the noise; and `alone`."""
    repeats = independent / samples
    return (
        1.0 + repeats * (left / noise - 1.0),
        1.0 + repeats * np.sqrt(2.0 / independent),
        repeats / noise,
        alone,
    )


@njit(cache=True)
def _settled(
    rows: tuple[Array, Array, Array, Array],
    share: float,
    usual: float,
    samples: float,
    tail: float,
    spread: float,
    times: int,
) -> float:
    """Return the usual mean square after some iterations of its fixed point (Kent, Tyler & Vardi 1994)."""
    seen, noise, repeats, sound = rows
    odds = math.log(share / (1.0 - share))
    for _ in range(times):
        found, counted = _LEAST, _LEAST
        for block in range(len(seen)):
            expected = noise[block] + repeats[block] * usual
            against = sound[block] - _beside(seen[block], expected, samples, tail, spread) - odds
            there = repeats[block] / (1.0 + math.exp(min(against, _MOST))) / (tail * expected + seen[block])
            found += there * seen[block] / expected
            counted += there
        usual *= found / counted
    return usual


@njit(cache=True)
def _value(
    rows: tuple[Array, Array, Array, Array],
    share: float,
    usual: float,
    samples: float,
    tail: float,
    spread: float,
) -> float:
    """Return the log likelihood of all blocks."""
    seen, noise, repeats, sound = rows
    total = 0.0
    for block in range(len(seen)):
        expected = noise[block] + repeats[block] * usual
        spoilt = math.log(share) + _beside(seen[block], expected, samples, tail, spread)
        alone = math.log(1.0 - share) + sound[block]
        greater = max(spoilt, alone)
        total += greater + math.log1p(math.exp(min(spoilt, alone) - greater))
    return total


@njit(cache=True)
def _beside(seen: float, expected: float, samples: float, tail: float, spread: float) -> float:
    """Return the log likelihood of a block with a discrepancy, of an expected mean square with the noise."""
    above = math.log1p((seen / expected - 1.0) / (tail + 1.0))
    return -0.5 * samples * (math.log(expected) + (tail + 1.0) * above + spread)
