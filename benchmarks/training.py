"""Training through the project beside its bare loop: python -m benchmarks.training --output PAGE.

Both train the TCN of `conf/model/tcn.yaml` on the same batches in the same order, on windows of numbers drawn at
random, and both go through the validation windows after every epoch.
"""

import argparse
import os
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from datetime import date
from functools import partial
from pathlib import Path

import torch
from torch import nn

from benchmarks.laps import Laps, in_turns
from benchmarks.page import machine, table
from simgap.models.accelerator import accelerator
from simgap.models.contract import FitContext
from simgap.models.examples import Examples
from simgap.models.settings import Training
from simgap.models.swerve_layout import SwerveLayout
from simgap.models.tcn import TemporalConvolutionModel, TemporalConvolutionSettings
from simgap.models.training import Regression, train_network

SETTINGS = TemporalConvolutionSettings()
WINDOWS = 120_000
VALIDATION = 0.2  # validation windows for each training window
BATCHES = (128, 512)
BAR = 0.6
OURS, BARE = "simgap", "bare loop"

_PAGE = """# Training speed

Made by `{command}` on {day}. {machine}

Both contenders train the TCN of `conf/model/tcn.yaml` ({parameters:,} parameters). The windows have {length} samples,
{features} features and {targets} targets, like those of a swerve drive.

- *simgap* is `simgap train`: PyTorch Lightning with early stopping, best weights and logging.
- The *bare loop* is forward pass, loss, backward pass and Adam step on the same batches, and the same validation.

They run in turns: {rounds} rounds of one epoch over {windows:,} windows, with {threads} threads. A rate is the median
over the rounds; brackets give minimum and maximum. The ratio is the median of the ratios within a round. The target is
{bar:.0%} of the bare loop.

{rates}
One epoch over {whole:,} windows takes {seconds:.0f} s with batches of {batch}, validation included.
"""


@dataclass(frozen=True)
class Problem:
    """Windows to train on and to validate on, and how.

    Attributes:
        train: windows.
        validation: windows.
        training: batch size; epochs.
    """

    train: Examples
    validation: Examples
    training: Training

    @classmethod
    def drawn(cls, windows: int, batch: int) -> "Problem":
        """Draw numbers of the size of a swerve drive's features and targets."""
        layout = _layout()
        random = torch.Generator().manual_seed(0)
        samples = windows + SETTINGS.sequence_length
        features = torch.randn(samples, len(layout.features), generator=random)
        targets = torch.randn(samples, len(layout.targets), generator=random)
        train = Examples(features, targets, torch.arange(windows), SETTINGS.sequence_length)
        validation = replace(train, starts=torch.arange(int(VALIDATION * windows)))
        return cls(train, validation, Training(max_epochs=1, batch_size=batch))


def ours(network: nn.Module, problem: Problem) -> None:
    """Train for an epoch as the project does."""
    train_network(network, problem.train, problem.validation, SETTINGS, problem.training, FitContext())


def bare(network: nn.Module, problem: Problem) -> None:
    """Train for an epoch with nothing but PyTorch."""
    size = problem.training.batch_size
    batches = Regression(network, problem.train, problem.validation, SETTINGS, size, seed=0).to(accelerator())
    batches.place()
    optimizer = torch.optim.Adam(network.parameters(), lr=SETTINGS.learning_rate)
    batches.on_train_epoch_start()
    network.train()
    for windows, targets in batches.train_dataloader():
        optimizer.zero_grad()
        nn.functional.mse_loss(network(windows), targets).backward()
        optimizer.step()
    network.eval()
    with torch.no_grad():
        for windows, targets in batches.val_dataloader():
            nn.functional.mse_loss(network(windows), targets)


def new_network() -> nn.Module:
    """Return the TCN with weights drawn by one seed."""
    torch.manual_seed(0)
    return TemporalConvolutionModel(_layout(), SETTINGS, time_step=0.02).network


def _rate(train: Callable[[nn.Module, Problem], None], problem: Problem) -> float:
    """Return windows per second."""
    network = new_network()
    start = time.perf_counter()
    train(network, problem)
    return len(problem.train) / (time.perf_counter() - start)


def _layout() -> SwerveLayout:
    columns = [f"{group}_voltage_{number}" for group in ("drive", "steer") for number in range(1, 5)]
    return SwerveLayout(tuple(columns))


def measured(windows: int, rounds: int) -> dict[int, dict[str, Laps]]:
    """Return the laps of both by batch size."""
    problems = {batch: Problem.drawn(windows, batch) for batch in BATCHES}
    return {
        batch: in_turns({OURS: partial(_rate, ours, problem), BARE: partial(_rate, bare, problem)}, rounds)
        for batch, problem in problems.items()
    }


def written(laps: dict[int, dict[str, Laps]], windows: int, rounds: int, load_before: float) -> str:
    """Return the page."""
    rows = [
        [f"{batch:,}", *(_text(found[name]) for name in (OURS, BARE)), f"{found[OURS].over(found[BARE]):.0%}"]
        for batch, found in laps.items()
    ]
    usual = Training().batch_size
    return _PAGE.format(
        command="make bench-training",
        day=date.today().isoformat(),
        machine=machine(accelerator().type, load_before),
        parameters=sum(weights.numel() for weights in new_network().parameters()),
        length=SETTINGS.sequence_length,
        features=len(_layout().features),
        targets=len(_layout().targets),
        rounds=rounds,
        windows=windows,
        bar=BAR,
        rates=table(["batch", f"{OURS}, windows/s", f"{BARE}, windows/s", "ratio"], rows),
        whole=WINDOWS,
        batch=usual,
        seconds=WINDOWS / laps[usual][OURS].median,
        threads=torch.get_num_threads(),
    )


def _text(laps: Laps) -> str:
    low, high = laps.spread
    return f"{laps.median:,.0f} ({low:,.0f}–{high:,.0f})"


def main() -> None:
    """Measure and write the page."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.training")
    parser.add_argument("--output", type=Path, default=Path("docs/benchmark_training.md"))
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--windows", type=int, default=WINDOWS, help="of an epoch")
    parser.add_argument("--threads", type=int, default=len(os.sched_getaffinity(0)))
    chosen = parser.parse_args()
    torch.set_num_threads(chosen.threads)
    load = os.getloadavg()[0]
    laps = measured(chosen.windows, chosen.rounds)
    chosen.output.write_text(written(laps, chosen.windows, chosen.rounds, load), encoding="utf-8")
    print(f"wrote {chosen.output}")


if __name__ == "__main__":
    main()
