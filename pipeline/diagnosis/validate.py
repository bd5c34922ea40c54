"""Validation: errors before and after on held-out runs."""

from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor

from simgap.equations.residuals import channels_on, residual_rows
from simgap.equations.row_noise import noise_of_rows
from simgap.equations.scoring import clusters_of
from simgap.gap.settings import BEYOND_NOISE
from simgap.physics.weak_form import WindowFunctions
from simgap.platforms.mechanism import Channel
from simgap.simulation import Simulator
from simgap.simulation.blocks import Blocks

_HELD_OUT_CLUSTER_DURATION = 5.0  # s
_PERCENTILES = (2.5, 97.5)


@dataclass(frozen=True)
class Validation:
    """Errors of two simulators on held-out runs, in one metric.

    Attributes:
        metric: what is compared, over which horizon, in which unit.
        held_out_runs: names.
        before: of the nominal simulator.
        after: of the simulator with the named effects.
        noise_floor: of a simulator that were right, by the sensors' noise alone.
        gap_closed: (before − after) / (before − noise_floor), at most 1; None where nothing could be held out.
        interval: 95 % bootstrap interval of it; None where fewer than two runs were held out.
        channels: RMS per channel: before, after, noise floor; (channels, 3).
        learned: of the simulator with the named effects and what was learned of the rest; None where nothing was.
    """

    metric: str
    held_out_runs: tuple[str, ...]
    before: float
    after: float
    noise_floor: float
    gap_closed: float | None
    interval: tuple[float, float] | None
    channels: Tensor
    learned: float | None

    @property
    def disproves(self) -> bool:
        """Whether runs that were used for nothing else are predicted worse than without what was named."""
        return self.gap_closed is not None and self.after > max(self.before, self.noise_floor)

    @property
    def refutes(self) -> bool:
        """Whether they are while more is left than noise can account for: then the names are hardly true."""
        return self.disproves and self.after**2 > BEYOND_NOISE * self.noise_floor**2


def validate(
    nominal: Simulator,
    augmented: Simulator,
    blocks: Blocks,
    functions: WindowFunctions,
    counted: list[Channel],
    held_out: bool,
    resamples: int,
    learned: Tensor | None = None,
) -> Validation:
    """Compare two simulators on blocks.

    Args:
        nominal: before.
        augmented: after.
        blocks: held-out runs; where there are none, the fitted ones, and then `held_out` is false.
        functions: windows that errors are averaged over.
        counted: the channels that enter the metric.
        held_out: whether the blocks were used for nothing else.
        resamples: of the bootstrap.
        learned: what a learned residual predicts beside the augmented simulator, (blocks, rows, channels).
    """
    names = [channel.name for channel in channels_on(nominal, blocks)]
    columns = [names.index(channel.name) for channel in counted]
    before, after = (residual_rows(simulator, blocks, functions) for simulator in (nominal, augmented))
    # A simulator whose forces jump looks noisy by itself: the quieter one shows what the sensors' noise can be at most.
    floor = torch.minimum(*(noise_of_rows(each, blocks, functions) for each in (nominal, augmented)))
    unit, size = _common_unit(counted, before[..., columns])
    energy = torch.stack(
        [(rows[..., columns] / size).square().mean((1, 2)) for rows in (before, after)], dim=1
    )  # (blocks, 2)
    noise = float((floor[columns] / size).square().mean())
    root = energy.mean(0).sqrt().tolist()
    closed = gap_closed(root[0], root[1], noise**0.5)
    width = float(functions.weights.gt(0).sum(1).max()) * blocks.time_step
    present = torch.unique(blocks.run).tolist()
    return Validation(
        metric=(
            f"RMS error of {', '.join(channel.name for channel in counted)} averaged over {width:.2g} s windows, "
            f"one-step, {unit}"
        ),
        held_out_runs=tuple(blocks.runs[run] for run in present) if held_out else (),
        before=root[0],
        after=root[1],
        noise_floor=noise**0.5,
        gap_closed=closed if held_out else None,
        interval=_interval(energy, noise, blocks, resamples) if held_out else None,
        channels=torch.stack(
            [before.square().mean((0, 1)).sqrt(), after.square().mean((0, 1)).sqrt(), floor], dim=1
        ),
        learned=None if learned is None else _rms((after - learned)[..., columns] / size),
    )


def _rms(rows: Tensor) -> float:
    return float(rows.square().mean().sqrt())


def _common_unit(counted: list[Channel], before: Tensor) -> tuple[str, Tensor]:
    """Return the unit of the metric: the channels' own where they share it, else the error before."""
    units = {channel.unit for channel in counted}
    if len(units) == 1:
        return f"in {units.pop()}", torch.ones(len(counted), dtype=torch.float64)
    return "each divided by its error before", before.square().mean((0, 1)).sqrt().clamp_min(1e-12)


def gap_closed(before: float, after: float, noise_floor: float) -> float:
    """Return the share of the gap above the noise that was closed, at most 1; 0 where there was no gap."""
    if before <= noise_floor:
        return 0.0
    return min((before - after) / (before - noise_floor), 1.0)


def _interval(energy: Tensor, noise: float, blocks: Blocks, resamples: int) -> tuple[float, float] | None:
    """Bootstrap over whole runs, or over stretches of 5 s where there are two to four runs; one run gives None.

    The stretches of one run share its load, its temperature and its floor: how much they differ says nothing of how
    another run would.
    """
    runs = torch.unique(blocks.run, return_inverse=True)[1]
    if int(runs.max()) < 1:
        return None
    groups = runs if int(runs.max()) >= 4 else clusters_of(blocks, _HELD_OUT_CLUSTER_DURATION)
    count = int(groups.max()) + 1
    summed = energy.new_zeros((count, 2)).index_add(0, groups, energy)
    counted = energy.new_zeros(count).index_add(0, groups, torch.ones(len(groups), dtype=energy.dtype))
    random = np.random.default_rng(0)
    drawn = torch.from_numpy(random.integers(0, count, (resamples, count)))
    means = (summed[drawn].sum(1) / counted[drawn].sum(1, keepdim=True)).sqrt()
    closed = [gap_closed(before, after, noise**0.5) for before, after in means.tolist()]
    low, high = np.percentile(closed, _PERCENTILES)
    return float(low), float(high)
