"""Folds, independent stretches and cross-validated residuals of fits."""

import torch
from torch import Tensor

from simgap.equations.fit import Fit, inverse_of
from simgap.simulation.blocks import Blocks

_CLUSTER_DURATION = 3.0  # s; residuals further apart count as independent
ENOUGH_CLUSTERS = 20
"""Least number of clusters of a test: cluster-robust errors are too small with fewer."""
_ENOUGH_RUNS = 3  # from which whole runs are left out
_UNEVEN = 2  # ratio of lengths of two runs, from which they are cut into stretches
_CLUSTER_ROUNDING = 1e-6  # of a cluster


def folds_of(blocks: Blocks, count: int) -> Tensor:
    """Return the fold of each block: whole runs where there are enough, else stretches of time; (blocks,)."""
    present, lengths = torch.unique(blocks.run, return_counts=True)
    even = len(present) > 1 and int(lengths.max()) < _UNEVEN * int(lengths.min())
    if len(present) >= _ENOUGH_RUNS or even:
        fold_of_run = torch.zeros(len(blocks.runs), dtype=torch.long)
        fold_of_run[present] = torch.arange(len(present)) % min(count, len(present))
        return fold_of_run[blocks.run]
    return (torch.arange(len(blocks)) * min(count, len(blocks))) // max(len(blocks), 1)


def clusters_of(blocks: Blocks, duration: float) -> Tensor:
    """Number stretches of about `duration` s inside each run, within which residuals may be correlated; (blocks,)."""
    stretch = torch.floor((blocks.start - blocks.start.min()) / duration + _CLUSTER_ROUNDING).long()
    return torch.unique(torch.stack([blocks.run, stretch]), dim=1, return_inverse=True)[1]


def independent_clusters(blocks: Blocks) -> Tensor:
    """Number stretches whose residuals count as independent: of 3 s, or of what gives twenty of them; (blocks,).

    A short recording has too few stretches of 3 s for any test, whatever it shows. None is shorter than a block.
    """
    block = blocks.samples * blocks.time_step
    return clusters_of(blocks, min(_CLUSTER_DURATION, max(block, len(blocks) * block / ENOUGH_CLUSTERS)))


def cross_validated(fit: Fit, fold: Tensor) -> Tensor:
    """Return residuals as if each fold had been left out of the fit: (blocks, rows, channels).

    The parameters move by one Newton step on the other folds, which is exact where the model is linear in them.
    """
    if fit.jacobian.shape[-1] == 0:
        return fit.residual
    weighted = fit.jacobian / fit.scale[..., None]
    gram = torch.einsum("brcp,brcq->bpq", weighted, weighted)
    score = torch.einsum("brcp,brc->bp", weighted, fit.residual / fit.scale)
    out = fit.residual.clone()
    for left_out in torch.unique(fold):
        kept, mine = fold != left_out, fold == left_out
        change = inverse_of(gram[kept].sum(0)) @ score[kept].sum(0)
        out[mine] = fit.residual[mine] - fit.jacobian[mine] @ change
    return out


def log_score(residual: Tensor, scale: Tensor) -> Tensor:
    """Return the Gaussian log likelihood of each block's residual, up to a constant: (blocks,)."""
    standard = residual / scale
    return -0.5 * (standard.square() + 2.0 * torch.log(scale)).sum((1, 2))
