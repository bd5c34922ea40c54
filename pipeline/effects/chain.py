"""Consecutive blocks of a recording joined into chains, for effects whose memory outlasts a block's margin."""

from dataclasses import dataclass
from typing import NamedTuple

import torch
from jaxtyping import Bool, Float, Int
from torch import Tensor

from simgap.effects.effect import Signals

_CLOSE = 0.1  # samples, greatest offset of a block's start from a sample of the block before


class Part(NamedTuple):
    """A block of a chain, and its start in samples after the start of the block before."""

    stretch: int
    later: int


@dataclass(frozen=True)
class Chains:
    """Chains of blocks that were recorded without a gap.

    Attributes:
        stretch: block of each sample of a chain, (chains, longest).
        sample: index in that block, (chains, longest); after its end a chain repeats its last sample.
        chain: chain of each block, (stretches,).
        first: sample of the chain at which each block starts, (stretches,).
        samples: number of samples in a block.
        recorded: False where a sample only repeats the last one of its chain, (chains, longest).
    """

    stretch: Int[Tensor, "chains longest"]
    sample: Int[Tensor, "chains longest"]
    chain: Int[Tensor, " stretches"]
    first: Int[Tensor, " stretches"]
    samples: int
    recorded: Bool[Tensor, "chains longest"]

    def joined(
        self, series: Float[Tensor, "stretches samples *rest"]
    ) -> Float[Tensor, "chains longest *rest"]:
        """Return a series of blocks (stretches, samples, ...) along the chains, (chains, longest, ...)."""
        return series[self.stretch, self.sample]

    def parted(
        self, series: Float[Tensor, "chains longest *rest"]
    ) -> Float[Tensor, "stretches samples *rest"]:
        """Return a series along the chains (chains, longest, ...) as blocks, (stretches, samples, ...)."""
        return series[self.chain[:, None], self.first[:, None] + torch.arange(self.samples)]


def chains_of(signals: Signals, time_step: float, most: int) -> Chains:
    """Join blocks (stretches, samples, ...) of one run (`run_number`) that overlap in time (`elapsed`).

    Without these signals every block is a chain of its own.

    Args:
        signals: the signals of the blocks.
        time_step: s.
        most: greatest number of blocks in a chain.
    """
    count, samples = next(iter(signals.values())).shape[:2]
    parts: list[list[Part]] = []
    if "run_number" not in signals or "elapsed" not in signals:
        return _chains([[Part(stretch, 0)] for stretch in range(count)], count, samples)
    runs, elapsed = signals["run_number"][:, 0].tolist(), signals["elapsed"]
    middle = elapsed[:, samples // 2]  # a block's ends may lie outside the recording, its middle never does
    last: dict[float, tuple[int, int]] = {}  # last block of each run, and its chain
    for stretch in torch.argsort(middle).tolist():
        before, chain = last.get(runs[stretch], (-1, -1))
        later = round(float(middle[stretch] - middle[before]) / time_step) if before >= 0 else samples
        if (
            later < samples
            and len(parts[chain]) < most
            and _is_same(elapsed, stretch, before, later, time_step)
        ):
            parts[chain].append(Part(stretch, later))
        else:
            chain = len(parts)
            parts.append([Part(stretch, 0)])
        last[runs[stretch]] = stretch, chain
    return _chains(parts, count, samples)


def _is_same(elapsed: Tensor, stretch: int, before: int, later: int, time_step: float) -> bool:
    """Whether a block starts `later` samples after another one, without a gap in time."""
    return abs(float(elapsed[stretch, 0] - elapsed[before, later])) < _CLOSE * time_step


def _chains(parts: list[list[Part]], count: int, samples: int) -> Chains:
    longest = samples + max(sum(each.later for each in part) for part in parts)
    stretch, sample = (torch.empty(len(parts), longest, dtype=torch.long) for _ in range(2))
    chain, first = (torch.empty(count, dtype=torch.long) for _ in range(2))
    recorded = torch.zeros(len(parts), longest, dtype=torch.bool)
    for number, part in enumerate(parts):
        start = 0
        for each in part:
            start += each.later
            stretch[number, start:] = each.stretch
            sample[number, start:] = torch.arange(longest - start).clamp_max(samples - 1)
            chain[each.stretch], first[each.stretch] = number, start
        recorded[number, : start + samples] = True
    return Chains(stretch, sample, chain, first, samples, recorded)
