"""Least squares with standard errors that hold for autocorrelated residuals.

Residuals of a moving robot are autocorrelated, so the jackknife leaves out blocks of time and not samples. Deleting one
block after the other (Künsch 1989, Ann. Stat. 17(3), "The jackknife and the bootstrap for general stationary
observations") gives a standard error for any function of the coefficients, without linearising it.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Table:
    """A linear regression's data.

    Attributes:
        regressors: (samples, regressors); no constant is added, and none is centred away.
        target: (samples,).
        block: block of each sample, integers (samples,).
    """

    regressors: np.ndarray
    target: np.ndarray
    block: np.ndarray

    def take(self, chosen: np.ndarray) -> "Table":
        """Return some of the samples."""
        return Table(self.regressors[chosen], self.target[chosen], self.block[chosen])


def join(pieces: Sequence[tuple[np.ndarray, np.ndarray, np.ndarray]]) -> Table:
    """Return one table of the pieces (regressors, target, block) of several segments."""
    regressors, target, block = (np.concatenate(parts) for parts in zip(*pieces, strict=True))
    return Table(regressors, target, block)


@dataclass(frozen=True)
class BlockRegression:
    """A fit and the fits with each block left out.

    Attributes:
        coefficients: (regressors,).
        left_out: coefficients without block b, (blocks, regressors).
        explained: share of the target's variance (about its mean) that the fit explains.
    """

    coefficients: np.ndarray
    left_out: np.ndarray
    explained: float


def fit_table(table: Table, ridge: float = 0.0) -> BlockRegression:
    """Fit target ≈ regressors · coefficients, and again without each block.

    Args:
        table: the data; every block that is numbered counts, in rising order.
        ridge: penalty per sample on the coefficients of regressors scaled to unit mean square.
    """
    regressors, target = table.regressors, table.target
    numbers, block = np.unique(table.block, return_inverse=True)
    count = len(numbers)
    scale = np.sqrt(np.mean(regressors**2, axis=0))
    scale[scale == 0.0] = 1.0
    scaled = regressors / scale
    gram = _sum_by_block(scaled[:, :, None] * scaled[:, None, :], block, count)  # (blocks, p, p)
    moment = _sum_by_block(scaled * target[:, None], block, count)  # (blocks, p)
    size = _sum_by_block(np.ones(len(target)), block, count)  # (blocks,)
    every = _solve(gram.sum(0), moment.sum(0), ridge * size.sum())
    left_out = _solve(gram.sum(0) - gram, moment.sum(0) - moment, ridge * (size.sum() - size)[:, None, None])
    residual = target - scaled @ every
    variance = float(np.var(target))
    explained = 1.0 - float(np.mean(residual**2)) / variance if variance > 0.0 else 0.0
    return BlockRegression(every / scale, left_out / scale, explained)


def jackknife_error(left_out: np.ndarray) -> np.ndarray:
    """Return the standard error of an estimate from its values with each block left out, (blocks, ...)."""
    count = len(left_out)
    if count < 2:
        return np.full(left_out.shape[1:], np.nan)
    return np.asarray(np.sqrt((count - 1) / count * np.sum((left_out - left_out.mean(0)) ** 2, axis=0)))


def is_determined(regressors: np.ndarray, limit: float = 1e-8) -> bool:
    """Return whether the regressors are independent enough to be told apart.

    Args:
        regressors: (samples, regressors).
        limit: smallest over largest eigenvalue of their normalised Gram matrix.
    """
    if len(regressors) < regressors.shape[1]:
        return False
    scale = np.sqrt(np.mean(regressors**2, axis=0))
    if np.any(scale == 0.0):
        return False
    eigenvalues = np.linalg.eigvalsh((regressors / scale).T @ (regressors / scale))
    return bool(eigenvalues[0] > limit * eigenvalues[-1])


def _sum_by_block(values: np.ndarray, block: np.ndarray, count: int) -> np.ndarray:
    total = np.zeros((count, *values.shape[1:]))
    np.add.at(total, block, values)
    return total


def _solve(gram: np.ndarray, moment: np.ndarray, penalty: float | np.ndarray) -> np.ndarray:
    penalised = gram + penalty * np.eye(gram.shape[-1])
    return (np.linalg.pinv(penalised, rcond=1e-12, hermitian=True) @ moment[..., None])[..., 0]
