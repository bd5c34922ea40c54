"""Blocks of equal length cut from a recording, which a simulator replays as one batch."""

from dataclasses import dataclass, field, replace
from functools import cached_property

import pandas as pd
import torch
from jaxtyping import Float, Int
from torch import Tensor

from simgap.errors import InputError
from simgap.physics.shapes import Series, Signal
from simgap.platforms import Platform
from simgap.recordings.excerpt import evenly
from simgap.recordings.recording import Recording
from simgap.simulation.signals import COMMANDS, rates_of, recorded_signals

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
        held_commands: those commands as they were recorded, where `signals` has the mean of what acts around a sample;
            a simulation holds them. By name, (blocks, margin + samples + margin, ...).
        resolution: what velocities are known to at each sample, in their units; of no concern to a simulation, which
            knows its own. By name, (blocks, margin + samples + margin, ...).
        noise_kept: share of white noise that a fifth difference still shows after interpolation, on average.
        rates: which signals act with their mean, and are the integral of which other one, by name.
    """

    signals: dict[str, Signal]
    run: Int[Tensor, " blocks"]
    runs: tuple[str, ...]
    start: Float[Tensor, " blocks"]
    time_step: float
    margin: int
    samples: int
    held: bool = True
    held_commands: dict[str, Signal] = field(default_factory=dict)
    resolution: dict[str, Signal] = field(default_factory=dict)
    rates: dict[str, str] = field(default_factory=dict)
    noise_kept: float = 1.0

    def __len__(self) -> int:
        return len(self.run)

    def take(self, index: Int[Tensor, " kept"]) -> "Blocks":
        """Return some of the blocks."""
        signals, held, resolution = (
            {name: series[index] for name, series in part.items()}
            for part in (self.signals, self.held_commands, self.resolution)
        )
        return replace(
            self,
            signals=signals,
            held_commands=held,
            resolution=resolution,
            run=self.run[index],
            start=self.start[index],
        )

    def of_runs(self, names: list[str]) -> "Blocks":
        """Return the blocks of some runs."""
        wanted = torch.tensor([name in set(names) for name in self.runs])
        return self.take(torch.nonzero(wanted[self.run]).squeeze(1))

    def inner(self, series: Float[Tensor, "blocks long *rest"]) -> Series:
        """Return a series without its margins."""
        return series[:, self.margin : self.margin + self.samples]

    @property
    def on_steps(self) -> bool:
        """Whether what acts is known step by step: commands are held, and known as they were recorded."""
        return self.held and bool(self.held_commands)

    @cached_property
    def acting(self) -> dict[str, Signal]:
        """What acts, by name, as long as `signals`: through each step where commands are held, else at each sample.

        Through the step that follows a sample its command is held, and all else has its mean until the next sample: of
        a position whose velocity runs in a straight line, h·(v₀ − v₁)/12 beside the mean of both.
        """
        if not self.on_steps:
            return self.signals | self.resolution
        means = self.acting_after(0.5)
        for position, velocity in self.rates.items():
            change = _one_later(self.signals[velocity]) - self.signals[velocity]
            means[position] = means[position] - self.time_step / 12.0 * change
        return means

    def acting_after(self, part: float) -> dict[str, Signal]:
        """Return what acts when a part of each step is over, by name, where commands are known step by step."""
        known = self.signals | self.resolution
        states = {name: series for name, series in known.items() if name not in self.held_commands}
        moved = {name: (1.0 - part) * series + part * _one_later(series) for name, series in states.items()}
        return moved | self.held_commands

    def acting_inside(self, series: Float[Tensor, "blocks long *rest"]) -> Series:
        """Return the part of a series of `acting` that the samples of the blocks lie in or between."""
        first = self.margin - 1 if self.on_steps else self.margin
        return series[:, first : self.margin + self.samples]

    def at_samples(self, series: Float[Tensor, "blocks steps *rest"]) -> Series:
        """Return what a series of `acting_inside` is around each sample: the mean of the steps before and after it."""
        return 0.5 * (series[:, :-1] + series[:, 1:]) if self.on_steps else series

    @property
    def filled(self) -> Float[Tensor, "blocks samples"]:
        """1 where an input was made up by cleaning, (blocks, samples)."""
        if "filled" not in self.signals:
            return torch.zeros(len(self), self.samples, dtype=torch.float64)
        return self.inner(self.signals["filled"])

    def thinned(self, most: int) -> "Blocks":
        """Return at most so many blocks, drawn evenly over the recording."""
        return self if len(self) <= most else self.take(torch.from_numpy(evenly(len(self), most)))


def cut_blocks(
    recording: Recording, platform: Platform, duration: float, margin_duration: float, held: bool = True
) -> Blocks:
    """Cut a cleaned recording into blocks that do not overlap; their margins do, and end with a segment's end held.

    Blocks never cross the end of a run or of a segment. Blocks and margins are shortened until every run has at least
    one block.

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
    started = recording.frame.groupby("run", sort=False)["t"].first()
    pieces: list[tuple[dict[str, Tensor], dict[str, Tensor]]] = []
    run: list[int] = []
    start: list[float] = []
    for segment in segments:
        firsts = range(0, len(segment) - samples + 1, samples)
        name = str(segment["run"].iloc[0])
        kept = (
            _kept_signals(
                segment, platform, held, (index[name], float(started[name])), margin, recording.derived
            )
            if firsts
            else ({}, {})
        )
        for first in firsts:
            within = slice(first, first + samples + 2 * margin)
            signals, commands = ({n: s[within] for n, s in part.items()} for part in kept)
            pieces.append((signals, commands))
            run.append(index[name])
            start.append(float(segment["t"].iloc[first]))
    return Blocks(
        signals=_stacked([signals for signals, _ in pieces]),
        run=torch.tensor(run),
        runs=runs,
        start=torch.tensor(start, dtype=torch.float64),
        time_step=time_step,
        margin=margin,
        samples=samples,
        held=held,
        held_commands=_stacked([commands for _, commands in pieces]),
        noise_kept=sum(recording.noise_kept.get(name, 1.0) for name in runs) / len(runs),
        rates=rates_of(platform),
    )


def _kept_signals(
    segment: pd.DataFrame,
    platform: Platform,
    held: bool,
    run: tuple[int, float],
    margin: int,
    derived: tuple[str, ...],
) -> tuple[dict[str, Tensor], dict[str, Tensor]]:
    """Return the padded signals of a segment of a run (number, start), and the held commands as they were recorded."""
    number, start = run
    signals = recorded_signals(segment, platform, held)
    signals["elapsed"] = torch.from_numpy(segment["t"].to_numpy(dtype="float64", copy=True)) - start
    signals["run_number"] = torch.full_like(signals["elapsed"], number)
    signals |= {f"derived_{name}": torch.ones_like(signals["elapsed"]) for name in derived}
    if "filled" in segment:
        signals["filled"] = _filled(segment, held)
    raw = recorded_signals(segment, platform, held=False) if held else {}
    commands = {name: series for name, series in raw.items() if name in COMMANDS}
    padded = ({name: _padded(s, margin) for name, s in part.items()} for part in (signals, commands))
    return next(padded), next(padded)


def _one_later(series: Tensor) -> Tensor:
    """Return a series (blocks, samples, ...) one sample on; the last one stays."""
    return torch.cat([series[:, 1:], series[:, -1:]], dim=1)


def _filled(segment: pd.DataFrame, held: bool) -> Tensor:
    """Return 1 at each sample around which an input that was made up acts, (samples,)."""
    filled = torch.from_numpy(segment["filled"].to_numpy(dtype="float64", copy=True))
    return torch.maximum(filled, torch.nn.functional.pad(filled[:-1], (1, 0))) if held else filled


def _stacked(pieces: list[dict[str, Tensor]]) -> dict[str, Tensor]:
    """Return the signals that every block has, (blocks, samples, ...)."""
    shared = set.intersection(*(set(piece) for piece in pieces))
    return {name: torch.stack([piece[name] for piece in pieces]) for name in sorted(shared)}


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
