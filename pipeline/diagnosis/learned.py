"""A learned residual for what has no name: the mean residual of the nearest recorded windows."""

from collections.abc import Sequence
from dataclasses import dataclass

import torch
from scipy import stats
from torch import Tensor

from simgap.diagnosis.regimes import Regime
from simgap.equations.problem import Problem
from simgap.physics.weak_form import WindowFunctions, mean_of
from simgap.platforms.mechanism import Channel
from simgap.recordings.excerpt import evenly
from simgap.simulation.knn_residual import NearestNeighbours

_NEIGHBOUR_COUNTS = (5, 15, 45, 135)  # numbers of neighbours
_MOST_SAMPLES = 4000  # windows that are stored
_LEARNED_LEVEL = 0.05  # level of the test, over all channels
_SLIGHT = 1.0  # of log likelihood: a bare mention (Kass & Raftery 1995, Bayes factors)
_FEATURE_ROUNDING = 1e-9  # of a feature's size
_LEAST_ENERGY = 0.2  # of the noise energy, as for a formula


@dataclass(frozen=True)
class LearnedResidual:
    """The residual of one channel as the mean of those at the nearest recorded windows.

    Kaufmann et al. 2023, "Champion-level drone racing using deep reinforcement learning", Nature 620, Methods.

    Attributes:
        channel: which equation of motion.
        features: the regime variables that windows are looked up by.
        neighbours: the windows, and what the named simulator leaves in them.
        explained: of the energy that it leaves, on runs left out, 0..1.
    """

    channel: Channel
    features: tuple[str, ...]
    neighbours: NearestNeighbours
    explained: float

    def rows(self, regimes: Sequence[Regime], functions: WindowFunctions) -> Tensor:
        """Return the residual to expect in the windows of other blocks, (blocks, rows), in the channel's unit."""
        by_name = {regime.name: regime for regime in regimes}
        features = _features([by_name[name] for name in self.features], functions)
        return self.neighbours(features.flatten(0, 1))[:, 0].reshape(features.shape[:2])


def learn(
    residual: Tensor, channels: Sequence[Channel], regimes: Sequence[Regime], problem: Problem, fold: Tensor
) -> list[LearnedResidual]:
    """Learn the residual of every channel where it improves the prediction of left-out runs.

    Args:
        residual: of the simulator with the named effects, (blocks, rows, channels).
        channels: names and units.
        regimes: what windows are looked up by; time is left out, for it does not come back.
        problem: blocks, windows and noise.
        fold: of each block, (blocks,).
    """
    known = [regime for regime in regimes if regime.name != "elapsed"]
    features = _features(known, problem.functions)
    kept = torch.from_numpy(evenly(len(residual), max(_MOST_SAMPLES // residual.shape[1], 1)))
    moving = _moving(features[kept].flatten(0, 1))
    names = tuple(regime.name for regime, moves in zip(known, moving.tolist(), strict=True) if moves)
    features = features[..., moving]
    found = []
    for place, channel in enumerate(channels):
        left = residual[..., place]
        if not _is_left(left, float(problem.noise[place]), float(problem.quadrature[place])):
            continue
        count, explained = _best_count(left, features, fold, kept)
        if not _predicts(explained, left, problem, place, len(channels)):
            continue
        neighbours = NearestNeighbours(
            features[kept].flatten(0, 1), left[kept].flatten()[:, None], min(count, left[kept].numel())
        )
        share = float(explained.sum() / left.square().sum())
        found.append(LearnedResidual(channel, names, neighbours, share))
    return found


def learned_rows(
    learned: Sequence[LearnedResidual],
    channels: Sequence[Channel],
    regimes: Sequence[Regime],
    functions: WindowFunctions,
) -> Tensor | None:
    """Return the learned residuals in other blocks, (blocks, rows, channels); None if none was learned."""
    if not learned:
        return None
    rows = {entry.channel.name: entry.rows(regimes, functions) for entry in learned}
    nothing = torch.zeros_like(next(iter(rows.values())))
    return torch.stack([rows.get(channel.name, nothing) for channel in channels], dim=-1)


def _features(regimes: Sequence[Regime], functions: WindowFunctions) -> Tensor:
    """Return the means of regime variables over the windows, (blocks, rows, features)."""
    return torch.stack([mean_of(functions, regime.series) for regime in regimes], dim=-1)


def _moving(features: Tensor) -> Tensor:
    """Return which features (windows, features) change by more than their rounding, (features,)."""
    return features.std(0) > _FEATURE_ROUNDING * features.abs().amax(0)


def _is_left(left: Tensor, noise: float, quadrature: float) -> bool:
    """Whether more is left than noise and quadrature error explain."""
    excess = float(left.square().mean()) - noise**2
    return excess > max(_LEAST_ENERGY * noise**2, quadrature**2)


def _best_count(left: Tensor, features: Tensor, fold: Tensor, kept: Tensor) -> tuple[int, Tensor]:
    """Return the number of neighbours that predicts best, and the energy that it explains on folds left out.

    The energy is of each block, (blocks,): the number is one of four, so that the choice hardly flatters it.
    """
    explained = {count: left.new_zeros(len(left)) for count in _NEIGHBOUR_COUNTS}
    for part in torch.unique(fold):
        mine, others = fold == part, kept[fold[kept] != part]
        known, outcome = features[others].flatten(0, 1), left[others].flatten()[:, None]
        for count in _NEIGHBOUR_COUNTS:
            if len(known) <= count or not bool(_moving(known).all()):
                continue
            predicted = NearestNeighbours(known, outcome, count)(features[mine].flatten(0, 1))
            error = left[mine] - predicted[:, 0].reshape(left[mine].shape)
            explained[count][mine] = (left[mine].square() - error.square()).sum(1)
    best = max(_NEIGHBOUR_COUNTS, key=lambda count: float(explained[count].sum()))
    return best, explained[best]


def _predicts(explained: Tensor, left: Tensor, problem: Problem, place: int, channels: int) -> bool:
    """Whether the explained energy is large enough and significant."""
    noise = float(problem.noise[place]) ** 2
    if float(explained.sum()) < _LEAST_ENERGY * noise * left.numel():
        return False
    clusters = explained.new_zeros(int(problem.cluster.max()) + 1)
    gained = clusters.index_add(0, problem.cluster, explained) / (2.0 * left.square().mean())
    chance = stats.ttest_1samp(gained.numpy(), 0.0, alternative="greater").pvalue
    return float(gained.sum()) > _SLIGHT and float(chance) <= _LEARNED_LEVEL / channels
