"""Presence: in which runs, or from when on, effects act.

A propeller is damaged in the third flight, a spring is taken off, a load is carried in some runs only. Such a change is
another hypothesis than effects that are there throughout, and the same score compares the two. One change may bring
several effects.
"""

from dataclasses import dataclass, replace
from typing import Any

import torch
from torch import Tensor

from simgap.simulation import Simulator
from simgap.simulation.blocks import Blocks


@dataclass(frozen=True)
class Presence:
    """Where in a recording some effects act.

    Attributes:
        keys: of the effects, sorted.
        runs: names of the runs in which they act, in the order of the recording.
        since: time in the first of them from which on they act, s; None: from the start of that run.
        until: time in the last of them until which they act, s; None: to the end of that run.
    """

    keys: tuple[str, ...]
    runs: tuple[str, ...]
    since: float | None = None
    until: float | None = None

    def acts(self, blocks: Blocks) -> Tensor:
        """Return in which blocks the effects act, (blocks,)."""
        inside = torch.tensor([name in self.runs for name in blocks.runs])[blocks.run]
        if self.since is not None:
            inside &= (blocks.run != blocks.runs.index(self.runs[0])) | (blocks.start >= self.since)
        if self.until is not None:
            inside &= (blocks.run != blocks.runs.index(self.runs[-1])) | (blocks.start < self.until)
        return inside

    def share(self, blocks: Blocks) -> Tensor:
        """Return how much of the effects acts in each block: all or nothing, (blocks,)."""
        return self.acts(blocks).to(blocks.start.dtype)

    def without(self, simulator: Simulator) -> Simulator:
        """Return a simulator as it is where the effects do not act."""
        return simulator.with_effects(tuple(f for f in simulator.effects if f.effect.key not in self.keys))

    def without_key(self, key: str) -> "Presence":
        """Return the same change with one effect less."""
        return replace(self, keys=tuple(each for each in self.keys if each != key))

    def joined_by(self, *keys: str) -> "Presence":
        """Return the same change with more effects."""
        return replace(self, keys=tuple(sorted({*self.keys, *keys})))

    @property
    def entries(self) -> list[Any]:
        """The runs as a diagnosis lists them: a name, or a mapping of `run` and `from` or `until`, s."""
        found: dict[str, dict[str, Any]] = {name: {"run": name} for name in self.runs}
        if self.since is not None:
            found[self.runs[0]]["from"] = self.since
        if self.until is not None:
            found[self.runs[-1]]["until"] = self.until
        return [entry if len(entry) > 1 else name for name, entry in found.items()]

    def sentence(self, every: tuple[str, ...]) -> str:
        """Return where one of the effects acts, as a person reads it.

        Args:
            every: the runs of the recording.
        """
        if self.since is not None:
            return f"It acts from {self.since:.4g} s of {self.runs[0]} on."
        if self.until is not None:
            return f"It acts until {self.until:.4g} s of {self.runs[-1]}."
        if len(self.runs) > 1 and self.runs == every[-len(self.runs) :]:
            return f"It acts from {self.runs[0]} on."
        return f"It acts in {_listed(self.runs)} only."


def beginning(blocks: Blocks, first: int) -> Presence:
    """Return the presence, still of no effect, from a block on in the order of the recording."""
    run, starts_run = _place(blocks, first)
    return Presence((), blocks.runs[run:], since=None if starts_run else float(blocks.start[first]))


def ending(blocks: Blocks, first: int) -> Presence:
    """Return the presence, still of no effect, until a block begins in the order of the recording."""
    run, starts_run = _place(blocks, first)
    if starts_run:
        last = int(blocks.run[first - 1])
        return Presence((), blocks.runs[: last + 1])
    return Presence((), blocks.runs[: run + 1], until=float(blocks.start[first]))


def _place(blocks: Blocks, first: int) -> tuple[int, bool]:
    """Return the run of a block, and whether the block before it is of another one."""
    run = int(blocks.run[first])
    return run, int(blocks.run[first - 1]) != run


def _listed(runs: tuple[str, ...]) -> str:
    *first, last = runs
    return f"{', '.join(first)} and {last}" if first else last
