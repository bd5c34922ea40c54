"""A recording cut into blocks of equal length, which a simulator can replay side by side."""

from dataclasses import dataclass, replace

import pandas as pd
import torch
from torch import Tensor

from pipeline.errors import InputError
from pipeline.platforms import Platform
from pipeline.recordings.recording import Recording
from pipeline.simulation.signals import recorded_signals

_FEWEST_SAMPLES = 10  # of a block


@dataclass(frozen=True)
class Blocks:
    """Stretches of a recording with a margin on both sides.

    Attributes:
        signals: by name, (blocks, margin + samples + margin, ...), float64.
        run: which run each block is from, (blocks,), an index into `runs`.
        runs: names of the runs.
        start: time of the first sample after the margin, (blocks,) s.
        time_step: s.
        margin: samples on each side that belong to no block: for delays, clock shifts and effects that remember.
        samples: length of a block without its margins.
        held: whether commands are held from one sample to the next.
    """

    signals: dict[str, Tensor]
    run: Tensor
    runs: tuple[str, ...]
    start: Tensor
    time_step: float
    margin: int
    samples: int
    held: bool = True

    def __len__(self) -> int:
        return len(self.run)

    def take(self, index: Tensor) -> "Blocks":
        """Return some of the blocks."""
        signals = {name: series[index] for name, series in self.signals.items()}
        return replace(self, signals=signals, run=self.run[index], start=self.start[index])

    def of_runs(self, names: list[str]) -> "Blocks":
        """Return the blocks of some runs."""
        wanted = torch.tensor([name in set(names) for name in self.runs])
        return self.take(torch.nonzero(wanted[self.run]).squeeze(1))

    def inner(self, series: Tensor) -> Tensor:
        """Return a series without its margins."""
        return series[:, self.margin : self.margin + self.samples]

    def thinned(self, most: int) -> "Blocks":
        """Return at most so many blocks, drawn evenly over the recording."""
        if len(self) <= most:
            return self
        return self.take(torch.linspace(0, len(self) - 1, most, dtype=torch.float64).round().long())


def cut_blocks(
    recording: Recording, platform: Platform, duration: float, margin_duration: float, held: bool = True
) -> Blocks:
    """Cut a cleaned recording into blocks that do not overlap; their margins do, and end with a segment's end held.

    Blocks never reach over the end of a run or of a segment. They are shortened, margins too, so far that every run has
    a part in the recording's blocks.

    Args:
        recording: cleaned.
        platform: whose signals are read.
        duration: of a block, s.
        margin_duration: of what is kept on each side of a block, s.
        held: whether commands are held between samples, see `recorded_signals`.

    Raises:
        InputError: when no segment holds even ten samples, or when the recording is not cleaned.
    """
    keys = ["run", "segment"] if "segment" in recording.frame else ["run"]
    segments = [segment for _, segment in recording.frame.groupby(keys, sort=False)]
    if max(map(len, segments), default=0) < _FEWEST_SAMPLES:
        raise InputError(
            "is too short to be replayed", recording.source or "recording", "record at least a few seconds"
        )
    time_step = recording.time_step
    samples, margin = _lengths(recording.frame, keys, duration / time_step, margin_duration / time_step)
    runs = tuple(recording.runs)
    index = {name: position for position, name in enumerate(runs)}
    pieces: list[dict[str, Tensor]] = []
    run: list[int] = []
    start: list[float] = []
    for segment in segments:
        firsts = range(0, len(segment) - samples + 1, samples)
        signals = recorded_signals(segment, platform, held) if firsts else {}
        padded = {name: _padded(series, margin) for name, series in signals.items()}
        for first in firsts:
            pieces.append({n: s[first : first + samples + 2 * margin] for n, s in padded.items()})
            run.append(index[str(segment["run"].iloc[0])])
            start.append(float(segment["t"].iloc[first]))
    shared = set.intersection(*(set(piece) for piece in pieces))
    return Blocks(
        signals={name: torch.stack([piece[name] for piece in pieces]) for name in sorted(shared)},
        run=torch.tensor(run),
        runs=runs,
        start=torch.tensor(start, dtype=torch.float64),
        time_step=time_step,
        margin=margin,
        samples=samples,
        held=held,
    )


def _padded(series: Tensor, margin: int) -> Tensor:
    """Hold the first and the last value before and after a segment, so that none of it is lost to margins."""
    return torch.cat(
        [series[:1].expand(margin, *series.shape[1:]), series, series[-1:].expand(margin, *series.shape[1:])]
    )


def _lengths(frame: pd.DataFrame, keys: list[str], samples: float, margin: float) -> tuple[int, int]:
    """Return samples and margin of a block, so that three fit into the longest segment of every run."""
    longest = frame.groupby(keys, sort=False).size().groupby(level=0 if len(keys) > 1 else "run").max()
    shortest = float(longest.min())
    return max(round(min(samples, shortest / 3)), _FEWEST_SAMPLES), max(round(min(margin, shortest / 8)), 2)
