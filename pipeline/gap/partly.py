"""What effects that act in a part of a recording promise, by the regression around a hypothesis."""

from collections.abc import Sequence

import numpy as np
import torch
from numpy.typing import NDArray

from simgap.gap.neighbours import RIDGE, Neighbours


class Partly:
    """The regression around a hypothesis, with some effects in some of its blocks only."""

    def __init__(self, near: Neighbours) -> None:
        """Begin with the regression.

        Args:
            near: the sets near the hypothesis, with its blocks.
        """
        self.near = near

    def promise(self, keys: Sequence[str], acting: NDArray[np.bool_]) -> float:
        """Return the score that the linearisation gives the hypothesis with some effects in some blocks only.

        Args:
            keys: of the effects.
            acting: in which blocks they act, (blocks,).
        """
        near = self.near
        left = torch.from_numpy(np.stack([self._left(keys, acting, each) for each in near.weights]))
        cost = sum(near.gain.get(key, 0.0) for key in keys)
        return near.centre.score + float(near.value(left).max() - near.present) + cost

    def saved(self, key: str, acting: NDArray[np.bool_]) -> NDArray[np.float64]:
        """Return roughly what log likelihood an effect in some blocks only saves, (weightings, choices).

        The values of all others stay.

        Args:
            key: of the effect.
            acting: in which blocks it acts, (choices, blocks).
        """
        near = self.near
        return near.share * 0.5 * np.stack([self._saved(key, acting, each) for each in near.weights])

    def sizes(self, key: str, acting: NDArray[np.bool_]) -> NDArray[np.float64]:
        """Return how much of an effect's first parameter some blocks show by themselves, without a sign, (choices,).

        Args:
            key: of the effect.
            acting: the blocks, (choices, blocks).
        """
        near = self.near
        own = near.columns[key][0 if key in near.mine else 1]
        _, alike = near.weights
        wanted = np.einsum("bc,bcq->b", alike, near.gram[..., own, self._absent([key])])
        there = np.einsum("bc,bc->b", alike, near.gram[..., own, own])
        return np.abs(acting @ wanted) / np.maximum(acting @ there, 1e-300)

    def _absent(self, keys: Sequence[str]) -> list[int]:
        """Return the columns whose sum is left where effects are absent."""
        return [0, *(self.near.offset[key] for key in keys if key in self.near.mine)]

    def _saved(self, key: str, acting: NDArray[np.bool_], weight: NDArray[np.float64]) -> NDArray[np.float64]:
        own, absent = self.near.columns[key], self._absent([key])
        chosen = [*absent, *own]
        total = np.einsum("bc,bcpq->bpq", weight, self.near.gram[..., chosen, :][..., chosen])
        first = len(absent)
        without = total[:, :first, :first].sum((1, 2)) - total[:, 0, 0]
        slope = acting @ total[:, first:, 0]
        square = np.einsum("ab,bpq->apq", acting.astype(float), total[:, first:, first:])
        size = np.einsum("app->ap", square)
        square = square + (RIDGE * size + 1e-300)[..., None] * np.eye(len(own))
        gained = np.einsum("ap,ap->a", slope, np.linalg.solve(square, slope[..., None])[..., 0])
        return gained - ~acting @ without

    def _left(
        self, keys: Sequence[str], acting: NDArray[np.bool_], weight: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return the mean squares that a regression with effects in some blocks leaves, (blocks, channels)."""
        near, absent = self.near, self._absent(keys)
        every = dict.fromkeys([*near.mine, *keys])
        chosen = [column for each in every for column in near.columns[each]]
        kept = np.array([float(each not in keys) for each in every for _ in near.columns[each]])
        there, elsewhere = (
            np.einsum("bc,bcpq->pq", weight[part], near.gram[part]) for part in (acting, ~acting)
        )
        cross = np.ix_(chosen, chosen)
        square = there[cross] + kept[:, None] * kept * elsewhere[cross]
        square = square + np.diag(RIDGE * np.diag(square) + 1e-300)
        target = there[chosen, 0] + kept * elsewhere[np.ix_(chosen, absent)].sum(1)
        step = np.linalg.solve(square, target)
        left = np.empty(near.gram.shape[:2])
        for part, moved, taken in ((acting, [0], step), (~acting, absent, kept * step)):
            change = np.zeros(near.gram.shape[-1])
            change[moved] = 1.0
            change[chosen] -= taken
            used = np.flatnonzero(change)
            left[part] = (near.gram[part][..., used[:, None], used] @ change[used]) @ change[used]
        return left
