"""Orthogonal least squares: greedy choice of regressors by explained variance.

Chen, Cowan & Grant 1991, "Orthogonal least squares learning algorithm for radial basis function networks",
IEEE Transactions on Neural Networks 2(2). The regressors are orthogonalised by a pivoted Cholesky factor of
their Gram matrix, which gives the same choice as their Gram–Schmidt procedure without a pass over the samples
per step (Chen & Wigger 1995, "Fast orthogonal least squares algorithm for efficient subset model selection",
IEEE Transactions on Signal Processing 43(7)).
"""

from dataclasses import dataclass

import torch
from torch import Tensor

_INDEPENDENT = 1e-10  # least share of a regressor that those chosen before must leave over


@dataclass(frozen=True)
class Choice:
    """The regressors that were chosen.

    Attributes:
        order: their numbers, in the order of their choice, (chosen,).
        weights: their least-squares coefficients, (chosen, targets).
        unexplained: share of the targets' energy that is left after each choice, (chosen,).
    """

    order: Tensor
    weights: Tensor
    unexplained: Tensor


def choose(gram: Tensor, moment: Tensor, energy: float, most: int, goal: float, first: int = 0) -> Choice:
    """Choose regressors until their fit reaches the goal.

    Args:
        gram: regressorsᵀ · regressors, (candidates, candidates) float64; a ridge on its diagonal regularises.
        moment: regressorsᵀ · targets, (candidates, targets).
        energy: sum of the squares of all targets.
        most: regressors to choose at most.
        goal: share of the energy that may stay unexplained.
        first: so many of the candidates are taken before any choice.
    """
    left_over, residual = gram.diagonal().clone(), moment.clone()
    factor = gram.new_zeros(len(gram), most)
    order: list[int] = []
    heights: list[Tensor] = []
    left = [energy]
    while len(order) < most and (left[-1] > goal * energy or len(order) < first):
        free = left_over > _INDEPENDENT * gram.diagonal()
        if len(order) < first:
            free[first:] = False
        if not free.any():
            break
        gain = torch.where(free, residual.square().sum(1) / left_over, -1.0)
        pick, count = int(gain.argmax()), len(order)
        column = gram[:, pick] - factor[:, :count] @ factor[pick, :count]
        factor[:, count] = column / left_over[pick].sqrt()
        heights.append(residual[pick] / left_over[pick].sqrt())
        residual -= factor[:, count, None] * heights[-1]
        left_over -= factor[:, count].square()
        left_over[pick] = 0.0
        order.append(pick)
        left.append(left[-1] - float(heights[-1].square().sum()))
    chosen = torch.tensor(order, dtype=torch.long, device=gram.device)
    triangle = factor[chosen, : len(order)].T
    weights = torch.linalg.solve_triangular(triangle, torch.stack(heights), upper=True)
    return Choice(chosen, weights, gram.new_tensor(left[1:]) / energy)
