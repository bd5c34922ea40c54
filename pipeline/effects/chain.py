"""Stretches of a recording joined where one goes on in the next, for effects that remember longer than a margin."""

from dataclasses import dataclass

import torch
from torch import Tensor

from pipeline.effects.effect import Signals

_CLOSE = 0.1  # samples, by which a stretch may start beside a sample of the one before


@dataclass(frozen=True)
class Chains:
    """What was recorded without a break, out of the stretches that it was cut into.

    Attributes:
        stretch: that each sample of a chain is taken from, (chains, longest).
        sample: of that stretch, (chains, longest); after its end a chain repeats its last one.
        chain: that each stretch belongs to, (stretches,).
        first: sample of the chain at which each stretch starts, (stretches,).
        samples: of a stretch.
        ended: whether a sample repeats the last one of its chain, (chains, longest).
    """

    stretch: Tensor
    sample: Tensor
    chain: Tensor
    first: Tensor
    samples: int
    ended: Tensor

    def joined(self, series: Tensor) -> Tensor:
        """Return a series of stretches (stretches, samples, ...) along the chains, (chains, longest, ...)."""
        return series[self.stretch, self.sample]

    def parted(self, series: Tensor) -> Tensor:
        """Return a series along the chains (chains, longest, ...) by stretches, (stretches, samples, ...)."""
        return series[self.chain[:, None], self.first[:, None] + torch.arange(self.samples)]


def chains_of(signals: Signals, time_step: float, most: int) -> Chains:
    """Join stretches (stretches, samples, ...) of one run (`run_number`) that overlap in time (`elapsed`).

    Where these signals are missing, every stretch is a chain of its own.

    Args:
        signals: of the stretches.
        time_step: s.
        most: stretches that are joined.
    """
    count, samples = next(iter(signals.values())).shape[:2]
    parts: list[
        list[tuple[int, int]]
    ] = []  # of each chain: stretches, and how many samples later each one starts
    last: dict[float, tuple[float, int]] = {}  # of each run: the time of its last stretch, and its chain
    middle = samples // 2  # a stretch's ends may lie beyond the recording, its middle never does
    known = "run_number" in signals and "elapsed" in signals
    runs = signals["run_number"][:, middle].tolist() if known else list(map(float, range(count)))
    times = signals["elapsed"][:, middle].tolist() if known else [0.0] * count
    for stretch in sorted(range(count), key=times.__getitem__):
        run, time = runs[stretch], times[stretch]
        before, chain = last.get(run, (-torch.inf, -1))
        later = (time - before) / time_step
        if later < samples and len(parts[chain]) < most and abs(later - round(later)) < _CLOSE:
            parts[chain].append((stretch, round(later)))
        else:
            chain = len(parts)
            parts.append([(stretch, 0)])
        last[run] = time, chain
    return _chains(parts, count, samples)


def _chains(parts: list[list[tuple[int, int]]], count: int, samples: int) -> Chains:
    longest = samples + max(sum(later for _, later in part) for part in parts)
    stretch, sample = (torch.empty(len(parts), longest, dtype=torch.long) for _ in range(2))
    chain, first = (torch.empty(count, dtype=torch.long) for _ in range(2))
    ended = torch.ones(len(parts), longest, dtype=torch.bool)
    for number, part in enumerate(parts):
        start = 0
        for one, later in part:
            start += later
            stretch[number, start:] = one
            sample[number, start:] = torch.arange(longest - start).clamp_max(samples - 1)
            chain[one], first[one] = number, start
        ended[number, : start + samples] = False
    return Chains(stretch, sample, chain, first, samples, ended)
