"""Location of the mismatch: tests per channel, and the regime of the largest error."""

from collections.abc import Sequence
from dataclasses import dataclass

import torch
from scipy import stats
from torch import Tensor

from simgap.diagnosis.regimes import Regime, bin_of, mean_per_bin, quantile_edges
from simgap.equations.problem import Problem
from simgap.equations.row_noise import TOLERATED
from simgap.physics.weak_form import mean_of
from simgap.platforms.mechanism import Channel
from simgap.recordings.doubts import LARGEST_AT
from simgap.simulation.blocks import Blocks

_BINS = 8
_MISMATCH_LEVEL = 1e-3
_EVERYWHERE = 0.75  # share of the recording, from which on a range of a variable says nothing
_AS_TELLING = 0.5  # of how much the energy varies over the variable that it depends on most
_WORDS = {
    "force_x": "along body x",
    "force_y": "along body y",
    "force_z": "along the thrust axis",
    "torque_x": "in roll",
    "torque_y": "in pitch",
    "torque_z": "in yaw",
    "drive_x": "in the drive along x",
    "drive_y": "in the drive along y",
    "drive_yaw": "in the drive about the vertical",
    "across_x": "across the wheels along x",
    "across_y": "across the wheels along y",
    "across_yaw": "across the wheels about the vertical",
    **{f"rolling_{module}": f"between the ground and wheel {module}" for module in range(1, 5)},
}


@dataclass(frozen=True)
class Mismatch:
    """A channel that the simulator does not explain.

    Attributes:
        channel: which equation of motion.
        share: of what the simulator leaves unexplained in all channels, 0..1.
        excess: energy of the residual over the noise's.
        regime: variable, low and high between which it fails most: all of the variable where it fails everywhere.
        runs: share of each run in the residual's energy above the noise.
        p_value: chance of such an energy if only sensor noise were there.
        where: one plain sentence.
    """

    channel: Channel
    share: float
    excess: float
    regime: tuple[str, float, float]
    runs: dict[str, float]
    p_value: float
    where: str


def locate(
    residual: Tensor, channels: Sequence[Channel], regimes: Sequence[Regime], problem: Problem
) -> list[Mismatch]:
    """Return the channels whose residual exceeds the noise, the worst first.

    The share of a channel is its part of log(1 + excess energy over the noise's), which compares channels of
    different units by how badly noise alone explains them.

    Args:
        residual: (blocks, rows, channels).
        channels: names and units.
        regimes: variables to look over.
        problem: blocks, windows and noise that the residual belongs to.
    """
    energy = residual.square().mean((0, 1))
    ratio = energy / problem.noise.square().clamp_min(1e-24)
    misfit = torch.log1p((ratio - 1.0).clamp_min(0.0))
    rows = residual.shape[0] * residual.shape[1]
    p_values = [_chance_of_noise(value, rows) for value in ratio.tolist()]
    guilty = [i for i, p in enumerate(p_values) if p < _MISMATCH_LEVEL]
    total = float(misfit[guilty].sum())
    averaged = [(regime, mean_of(problem.functions, regime.series).flatten()) for regime in regimes]
    found = []
    for i in guilty:
        worst = _worst_regime(residual[..., i].flatten(), averaged)
        rms, noise = float(energy[i].sqrt()), float(problem.noise[i])
        sentence = _sentence(channels[i], rms, noise, worst)
        low_high = (worst.regime.name, worst.low, worst.high)
        share = float(misfit[i]) / total
        runs = _share_of_runs(residual[..., i], problem.noise[i], problem.blocks)
        found.append(Mismatch(channels[i], share, float(ratio[i]), low_high, runs, p_values[i], sentence))
    return sorted(found, key=lambda mismatch: -mismatch.share)


def _share_of_runs(residual: Tensor, noise: Tensor, blocks: Blocks) -> dict[str, float]:
    """Return the share of each run in the energy above the noise of a residual (blocks, rows), the greatest first."""
    excess = residual.square().mean(1) - noise.square()
    summed = {
        blocks.runs[run]: float(excess[blocks.run == run].sum()) for run in blocks.run.unique().tolist()
    }
    total = sum(max(value, 0.0) for value in summed.values()) or 1.0
    shares = {run: max(value, 0.0) / total for run, value in summed.items()}
    return dict(sorted(shares.items(), key=lambda item: -item[1]))


def _chance_of_noise(ratio: float, rows: int) -> float:
    """Return the chance that white noise alone gives this energy over the noise's (χ² test).

    Neighbouring windows overlap by half, which leaves half as many independent rows.
    """
    freedom = max(rows / 2, 1.0)
    return float(stats.chi2.sf(freedom * ratio / TOLERATED, freedom))


@dataclass(frozen=True)
class _Worst:
    """The range of a variable in which a residual is above average, or all of it where that says nothing."""

    regime: Regime
    low: float
    high: float
    everywhere: bool = False


def _worst_regime(residual: Tensor, regimes: Sequence[tuple[Regime, Tensor]]) -> _Worst:
    """Return the variable that the residual's energy depends on most, and the range where it is above average.

    A range that holds nearly all of the recording says nothing: then it is the next variable's that the energy depends
    on nearly as much, or all of the first variable where there is no such one.
    """
    energy, found = residual.square(), []
    for regime, values in regimes:
        edges = quantile_edges(values, _BINS)
        if len(edges) < 3:
            continue
        place = bin_of(values, edges)
        means = mean_per_bin(energy, place, len(edges) - 1)
        score = float((means[place] - energy.mean()).square().mean())
        above = torch.nonzero(means >= energy.mean()).flatten()
        first, last = int(above.min()), int(above.max())
        share = float(((place >= first) & (place <= last)).double().mean())
        found.append((score, share, _Worst(regime, float(edges[first]), float(edges[last + 1]))))
    if not found:
        return _all_of(*regimes[0])
    telling = max(score for score, *_ in found)
    narrow = [each for each in found if each[1] <= _EVERYWHERE and each[0] >= _AS_TELLING * telling]
    if narrow:
        return max(narrow, key=lambda each: each[0])[2]
    most = max(found, key=lambda each: each[0])[2].regime
    return _all_of(*next(entry for entry in regimes if entry[0] is most))


def _all_of(regime: Regime, values: Tensor) -> _Worst:
    return _Worst(regime, float(values.min()), float(values.max()), everywhere=True)


def _sentence(channel: Channel, rms: float, noise: float, worst: _Worst) -> str:
    place = _WORDS.get(channel.name, f"in {channel.name.replace('_', ' ')}")
    size = f"The simulator's error {place} is {rms:.2g} {channel.unit}; sensor noise alone would give {noise:.2g}."
    if worst.everywhere:
        return size
    name, unit = worst.regime.name.replace("_", " "), worst.regime.unit
    return f"{size} {LARGEST_AT} {name} {worst.low:.2g} to {worst.high:.2g} {unit}."
