"""Which hypotheses near one are worth fitting: all sets within two effects of it, scored on its linearisation.

An effect that another one stands in for cannot be added alone, nor the other one dropped alone. Sets that differ by two
effects are many, and a fit of each would be slow. Around a fit every effect adds columns to one regression, from which
the residual of each set follows without the simulator.
"""

from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from simgap.effects import Effect
from simgap.equations.fit import columns_of
from simgap.equations.refit import remove
from simgap.equations.temper import Mixture
from simgap.gap.hypothesis import Hypothesis
from simgap.gap.prior import log_odds
from simgap.simulation import FittedEffect

_BLOCKS = 60
"""Blocks that sets are scored on, drawn evenly: what is promising needs no more."""
_WEIGHED = 60
"""Sets whose promise is worked out in full."""
RIDGE = 1e-9
"""Of a column's own energy: two effects with the same column share it."""


@dataclass(frozen=True)
class Proposal:
    """A set of effects near a hypothesis.

    Attributes:
        keys: of its effects.
        effects: with values to start a fit from.
        promise: the score that the linearisation gives it.
    """

    keys: frozenset[str]
    effects: tuple[FittedEffect, ...]
    promise: float


class Neighbours:
    """The sets within two effects of one hypothesis."""

    def __init__(
        self, centre: Hypothesis, added: Sequence[Hypothesis], dropped: Mapping[str, Hypothesis]
    ) -> None:
        """Set the regression up.

        Args:
            centre: the hypothesis.
            added: the same with one more effect each.
            dropped: the same without one of its effects, by that effect's key.
        """
        problem = centre.reading.problem
        self.centre = centre
        self.mine = {f.effect.key: f for f in centre.fit.simulator.free}
        self.new = {f.effect.key: f for f in map(_last, added)}
        # An effect that does nothing beside the others has no prior of its own, and may do much in their place.
        constants = centre.fit.simulator.constants()
        self.gain = {
            _last(h).effect.key: h.occam - centre.occam + log_odds(_last(h).effect, constants) for h in added
        }
        # What an effect costs in parameters and rarity comes back where it goes.
        self.relief = {key: h.occam + h.prior - centre.occam - centre.prior for key, h in dropped.items()}
        self.columns: dict[str, list[int]] = {}
        self.offset: dict[str, int] = {}
        series = [centre.fit.residual[..., None]]
        for key, fitted in self.mine.items():
            self.offset[key] = sum(part.shape[-1] for part in series)
            without = remove(centre.fit, fitted.effect, problem, centre.reading.known(fitted.effect))
            gone = without.residual - centre.fit.residual
            series.append(gone[..., None])
            self._note(key, series, centre.fit.jacobian[..., columns_of(centre.fit, fitted.effect)])
        for hypothesis in added:
            effect = _last(hypothesis).effect
            own = hypothesis.fit.jacobian[..., columns_of(hypothesis.fit, effect)]
            self._note(effect.key, series, torch.cat([_contribution(hypothesis, centre), own], dim=-1))
        self.part = part = _spread(len(centre.fit.residual))
        self.gram = _gram(torch.cat([each[part] for each in series], dim=-1))
        self.temper = centre.reading.likelihood_of.temper.of_blocks(part)
        self.share = len(centre.fit.residual) / len(part)
        self.noise = centre.likelihood.noise[part]
        self.left = centre.likelihood.left[part]
        self.mixture, self.present = self.temper.mixture(self.left, self.noise), self.value(self.left)
        self.weights = [each.numpy() for each in _weights(centre, part)]
        self.totals = [np.einsum("bc,bcpq->pq", each, self.gram) for each in self.weights]
        for hypothesis in added:
            self.gain[_last(hypothesis).effect.key] -= self._overstated(hypothesis)

    def _overstated(self, hypothesis: Hypothesis) -> float:
        """Return by how much the linearisation promises more of an effect alone than it keeps, in log likelihood.

        It may promise that a scale makes all rows vanish.
        """
        left = torch.from_numpy(self._left((), (_last(hypothesis).effect.key,)))
        promised = float((self.value(left) - self.present).max())
        return max(promised - (hypothesis.likelihood.value - self.centre.likelihood.value), 0.0)

    def _note(self, key: str, series: list[Tensor], columns: Tensor) -> None:
        first = sum(part.shape[-1] for part in series)
        self.columns[key] = list(range(first, first + columns.shape[-1]))
        series.append(columns)

    def best(self, count: int, known: Container[frozenset[str]]) -> list[Proposal]:
        """Return the most promising sets that are not among the known ones, best first."""
        keys = frozenset(self.mine)
        sets = {(keys - set(gone)) | set(come): (gone, come) for gone, come in self._moves()}
        moves = [(each, *move) for each, move in sets.items() if each not in known]
        if not moves:
            return []
        left = torch.from_numpy(np.stack([self._left(gone, come) for _, gone, come in moves]))
        costs = torch.tensor([self._cost(gone, come) for _, gone, come in moves], dtype=torch.float64)
        # The mixture of the centre ranks them, with what is usual smaller where less is left; the best have their own.
        likely = (
            (self.value(left, self._scaled(left)).amax(-1) + costs).topk(min(_WEIGHED, len(moves))).indices
        )
        promises = self.centre.score + self.value(left[likely]).amax(-1) - self.present + costs[likely]
        order = promises.argsort(descending=True)[:count].tolist()
        found = [(moves[int(likely[place])][0], float(promises[place])) for place in order]
        return [Proposal(keys, self._starts(keys), promise) for keys, promise in found]

    @property
    def changeable(self) -> list[str]:
        """Effects that may act in a part of the recording: of the hypothesis or not, but not known before."""
        known = {fitted.effect.key for fitted in self.centre.reading.nominal.known}
        mine = self.mine.keys() & self.centre.doubtful
        return [*sorted(mine - known), *sorted(self.new.keys() - known)]

    @property
    def own(self) -> list[int]:
        """The columns of the effects of the hypothesis."""
        return [column for key in self.mine for column in self.columns[key]]

    def contribution(self, key: str) -> int:
        """Return the column of what an effect as a whole takes off the residual."""
        return self.offset[key] if key in self.mine else self.columns[key][0]

    def cost_of(self, key: str) -> float:
        """Return what an effect, or a second one of its kind, adds to the score beside the likelihood."""
        return self.gain[key] if key in self.gain else -self.relief.get(key, 0.0)

    def values_of(self, key: str) -> dict[str, float]:
        """Return the values that an effect has in the hypothesis, or with which it would be added."""
        return dict((self.new | self.mine)[key].values)

    def starts_with(self, keys: Sequence[str]) -> tuple[FittedEffect, ...]:
        """Return the effects of the hypothesis and others, with values to start a fit from."""
        return self._starts(frozenset(self.mine).union(keys))

    def _moves(self) -> Iterator[tuple[tuple[str, ...], tuple[str, ...]]]:
        """Yield which effects go and which come: at most two of each, and more than one in all."""
        presence = self.centre.reading.presence
        staying = presence.keys if presence else ()  # without them it would be no change
        mine = [key for key in self.mine if key in self.centre.doubtful and key not in staying]
        goings = [(), *combinations(mine, 1), *combinations(mine, 2)]
        comings = [(), *combinations(self.new, 1), *combinations(self.new, 2)]
        for gone in goings:
            for come in comings:
                if 2 <= len(gone) + len(come) <= 3:
                    yield gone, come

    def _cost(self, gone: tuple[str, ...], come: tuple[str, ...]) -> float:
        """Return what a move changes of the score beside the likelihood."""
        return sum(self.gain[key] for key in come) + sum(self.relief.get(key, 0.0) for key in gone)

    def _left(self, gone: tuple[str, ...], come: tuple[str, ...]) -> NDArray[np.float64]:
        """Return the mean squares that regressions under each weighting leave, (weightings, blocks, channels)."""
        present = (*(key for key in self.mine if key not in gone), *come)
        chosen = [column for key in present for column in self.columns[key]]
        moved = [0, *(self.offset[key] for key in gone)]
        return np.stack([self._left_by(total, moved, chosen) for total in self.totals])

    def _left_by(
        self, total: NDArray[np.float64], moved: list[int], chosen: list[int]
    ) -> NDArray[np.float64]:
        """Return the mean square that a regression of moved columns on chosen ones leaves, (blocks, channels)."""
        change = np.zeros(self.gram.shape[-1])
        change[moved] = 1.0
        if chosen:
            square = total[np.ix_(chosen, chosen)]
            square = square + np.diag(RIDGE * np.diag(square) + 1e-300)
            change[chosen] -= np.linalg.solve(square, total[chosen] @ change)
        used = np.flatnonzero(change)
        part, kept = change[used], self.gram[..., used[:, None], used]
        return (kept @ part) @ part

    def value(self, left: Tensor, mixture: Mixture | None = None) -> Tensor:
        """Return the log likelihood of all blocks, (...,), of some whose mean squares are left."""
        floored = torch.maximum(left, self.noise)
        mixture = mixture or self.temper.mixture(floored, self.noise)
        return self.share * self.temper.value_of(mixture, floored, self.noise).sum(-1)

    def _scaled(self, left: Tensor) -> Mixture:
        """Return the mixture of the centre with a discrepancy as large as what is left, (..., blocks, channels)."""
        ratio = torch.maximum(left, self.noise).log() - self.left.log()
        return Mixture(self.mixture.share, self.mixture.usual * ratio.mean(-2, keepdim=True).exp())

    def _starts(self, keys: frozenset[str]) -> tuple[FittedEffect, ...]:
        every = self.new | self.mine
        return tuple(FittedEffect(every[key].effect, every[key].values) for key in sorted(keys))


def _last(hypothesis: Hypothesis) -> FittedEffect:
    return hypothesis.fit.simulator.free[-1]


def _spread(blocks: int) -> list[int]:
    """Return some of the blocks, drawn evenly."""
    return torch.linspace(0, blocks - 1, min(blocks, _BLOCKS)).round().long().tolist()


def _contribution(hypothesis: Hypothesis, centre: Hypothesis) -> Tensor:
    """Return what the last effect of a hypothesis takes off the centre's residual, (blocks, rows, channels, 1)."""
    effect: Effect = _last(hypothesis).effect
    others = [
        c for c in range(hypothesis.fit.jacobian.shape[-1]) if c not in columns_of(hypothesis.fit, effect)
    ]
    moved = hypothesis.fit.values[others] - centre.fit.values
    taken = centre.fit.residual - hypothesis.fit.residual - hypothesis.fit.jacobian[..., others] @ moved
    return taken[..., None]


def _weights(centre: Hypothesis, part: list[int]) -> tuple[Tensor, Tensor]:
    """Return what a squared residual counts, (blocks, channels): as now, and all alike.

    Rows that are met weigh far more than those that are missed, and would hide what explains the latter.
    """
    left = centre.likelihood.left[part]
    return centre.likelihood.weight[part], (1.0 / left.mean(0)).expand_as(left)


def _gram(series: Tensor) -> NDArray[np.float64]:
    """Return the mean products of columns (blocks, rows, channels, columns), (blocks, channels, columns, columns)."""
    return (torch.einsum("brcp,brcq->bcpq", series, series) / series.shape[1]).numpy()
