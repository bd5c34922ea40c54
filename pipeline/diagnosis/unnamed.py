"""A formula for the residual that no effect explains, found by sparse regression over recorded signals."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import torch
from scipy import stats
from torch import Tensor

from simgap.diagnosis.regimes import Regime
from simgap.equations.problem import Problem
from simgap.gap.likelihood import INEXACT
from simgap.physics.weak_form import mean_of
from simgap.platforms.mechanism import Channel

_MOST_TERMS = 4
_HARMONICS = 12  # of one turn of a joint
_FORMULA_LEVEL = 1e-3  # level of the test, over the whole library
_LEAST_ENERGY = 0.2  # of the noise energy, which a formula must explain
_LEAST_STEP = 0.02  # of the remaining energy, cross-validated, which one more term must explain


@dataclass(frozen=True)
class Unnamed:
    """Structure in a channel's residual that no effect of the catalogue explains.

    Attributes:
        channel: which equation of motion.
        depends_on: the signals in the formula.
        formula: the residual in the channel's unit, signals in SI units.
        share: of what the nominal simulator leaves unexplained in that channel above the noise.
        size: RMS of what the formula explains, in the channel's unit.
        noise: RMS of the sensors' noise in that channel, in the same unit.
    """

    channel: Channel
    depends_on: tuple[str, ...]
    formula: str
    share: float
    size: float
    noise: float


@dataclass(frozen=True)
class _Term:
    text: str
    signals: tuple[str, ...]
    series: Tensor  # (blocks * rows,)


def find_unnamed(
    residual: Tensor,
    nominal_residual: Tensor,
    channels: Sequence[Channel],
    regimes: Sequence[Regime],
    problem: Problem,
    fold: Tensor,
    least_share: float,
) -> list[Unnamed]:
    """Return a formula for every channel whose residual still depends on the recorded signals.

    Terms enter one at a time by orthogonal matching pursuit and stay only if they predict runs they were not fitted on.
    Source: Brunton, Proctor & Kutz 2016, Sparse identification of nonlinear dynamics (PNAS 113).

    Args:
        residual: of the simulator with the named effects, cross-validated, (blocks, rows, channels).
        nominal_residual: of the nominal simulator.
        channels: names and units.
        regimes: the signals to build terms of.
        problem: blocks, windows and noise.
        fold: of each block, (blocks,).
        least_share: of the excess energy that a formula must explain.
    """
    terms = _library(regimes, problem)
    rows = residual.shape[1]
    row_fold, row_cluster = (label.repeat_interleave(rows) for label in (fold, problem.cluster))
    found = []
    for i, channel in enumerate(channels):
        noise = float(problem.noise[i]) ** 2
        excess = max(float(nominal_residual[..., i].square().mean()) - noise, 0.01 * noise)
        left = residual[..., i].flatten()
        chosen, explained = _pursue(left, terms, row_fold, row_cluster)
        least = max(least_share * excess, _LEAST_ENERGY * noise, float(problem.quadrature[i]) ** 2)
        if chosen and explained > least:
            formula = _formula(chosen, left)
            signals = tuple(dict.fromkeys(signal for term in chosen for signal in term.signals))
            share = min(explained / excess, 1.0)
            found.append(Unnamed(channel, signals, formula, share, explained**0.5, noise**0.5))
    return found


def _library(regimes: Sequence[Regime], problem: Problem) -> list[_Term]:
    """Return constants, signals, their squares with sign, products of two and waves of an angle, over the windows."""
    signals = {regime.name: regime.series for regime in regimes}
    shape = next(iter(signals.values()))
    series: list[tuple[str, tuple[str, ...], Tensor]] = [("1", (), torch.ones_like(shape))]
    series += [(name, (name,), value) for name, value in signals.items()]
    series += [(f"{name}·|{name}|", (name,), value * value.abs()) for name, value in signals.items()]
    pairs = itertools.combinations(signals.items(), 2)
    series += [(f"{a}·{b}", (a, b), x * y) for (a, x), (b, y) in pairs]
    turning = [regime for regime in regimes if regime.name == "position" and regime.unit == "rad"]
    for k, wave in itertools.product(range(1, _HARMONICS + 1), (torch.sin, torch.cos)):
        series += [(f"{wave.__name__}({k}·position)", (r.name,), wave(k * r.series)) for r in turning]
    return [_Term(text, names, mean_of(problem.functions, value).flatten()) for text, names, value in series]


def _pursue(left: Tensor, terms: list[_Term], fold: Tensor, cluster: Tensor) -> tuple[list[_Term], float]:
    """Return the chosen terms and the energy that they explain on folds left out.

    A term was chosen as the best of many on all the data, so that its own test has to allow for the choice. It must
    explain more than the terms before it may leave, which are no more exact than laws are.
    """
    matrix = torch.stack([term.series for term in terms], dim=1)
    size = matrix.square().mean(0).sqrt().clamp_min(1e-12)
    matrix = matrix / size
    start = energy = float(left.square().mean())
    chosen: list[int] = []
    remaining = left
    while len(chosen) < _MOST_TERMS:
        correlation = (matrix.T @ remaining).abs()
        correlation[chosen] = 0.0
        tried = [*chosen, int(correlation.argmax())]
        after = _cross_validated_energy(matrix[:, tried], left, fold)
        chance = _chance_of_last(matrix[:, tried], left, cluster) * len(terms)
        least = max(_LEAST_STEP * energy, INEXACT**2 * (start - energy))
        if energy - after < least or chance > _FORMULA_LEVEL:
            break
        chosen, energy = tried, after
        weights = torch.linalg.lstsq(matrix[:, chosen], left[:, None]).solution
        remaining = left - (matrix[:, chosen] @ weights)[:, 0]
    return [terms[i] for i in chosen], start - energy


def _chance_of_last(matrix: Tensor, left: Tensor, cluster: Tensor) -> float:
    """Return the chance of a weight as great as the last column's if there were nothing (t test, clustered errors)."""
    bread = torch.linalg.pinv(matrix.T @ matrix, hermitian=True)
    weights = bread @ (matrix.T @ left)
    score = matrix * (left - matrix @ weights)[:, None]
    groups = int(cluster.max()) + 1
    summed = score.new_zeros((groups, matrix.shape[1])).index_add(0, cluster, score)
    variance = (bread @ (summed.T @ summed) @ bread)[-1, -1] * (groups / max(groups - 1, 1))
    statistic = float(weights[-1].abs() / variance.clamp_min(1e-300).sqrt())
    return float(2.0 * stats.t.sf(statistic, max(groups - matrix.shape[1], 1)))


def _cross_validated_energy(matrix: Tensor, left: Tensor, fold: Tensor) -> float:
    gram_all, score_all = matrix.T @ matrix, matrix.T @ left
    energy = 0.0
    for part in torch.unique(fold):
        mine = fold == part
        held = matrix[mine]
        weights = torch.linalg.pinv(gram_all - held.T @ held, hermitian=True) @ (
            score_all - held.T @ left[mine]
        )
        energy += float((left[mine] - held @ weights).square().sum())
    return energy / len(left)


def _formula(chosen: list[_Term], left: Tensor) -> str:
    matrix = torch.stack([term.series for term in chosen], dim=1)
    weights = torch.linalg.lstsq(matrix, left[:, None]).solution[:, 0].tolist()
    parts = [
        f"{weight:+.3g}" + ("" if term.text == "1" else f"·{term.text}")
        for weight, term in zip(weights, chosen, strict=True)
    ]
    return " ".join(parts)
