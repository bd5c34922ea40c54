"""Windows over recorded series, by index: the samples stay in one tensor and are gathered per batch."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np
import torch
from torch import Tensor

from simgap.errors import InputError
from simgap.models.layout import Layout
from simgap.models.segments import segments
from simgap.recordings.recording import Recording


@dataclass(frozen=True)
class Series:
    """The samples of some runs, one segment after the other.

    Attributes:
        states: (samples, states) float64.
        actions: inputs, (samples, inputs) float64.
        bounds: first sample of each segment and the one after its last, (segments, 2).
        time_step: s.
    """

    states: Tensor
    actions: Tensor
    bounds: Tensor
    time_step: float

    def __len__(self) -> int:
        return len(self.states)

    def to(self, device: torch.device) -> "Series":
        """Return the same samples on a device."""
        return replace(self, states=self.states.to(device), actions=self.actions.to(device))

    def starts(self, length: int) -> Tensor:
        """Return the first sample of every window of `length` samples that stays inside one segment."""
        pieces = [torch.arange(first, max(last - length + 1, first)) for first, last in self.bounds.tolist()]
        return torch.cat(pieces) if pieces else torch.zeros(0, dtype=torch.long)

    def stretches(self, length: int, steps: int) -> Tensor:
        """Return the first samples of windows whose next `steps` samples follow on each other, inside segments."""
        pieces = [
            torch.arange(first, max(last - length - steps + 1, first), max(steps, 1))
            for first, last in self.bounds.tolist()
        ]
        return torch.cat(pieces) if pieces else torch.zeros(0, dtype=torch.long)

    def excerpt(self, share: float, shift: float = 0.0) -> "Series":
        """Return a part of the samples, as if the segments stood end to end.

        Args:
            share: of the samples, over 0 to 1.
            shift: share of the samples that come before.

        Raises:
            InputError: when the part is none, or ends after the samples do.
        """
        if not (0.0 < share <= 1.0 and 0.0 <= shift <= 1.0 - share + 1e-9):
            found = f"share {share} from {shift} on is no part"
            raise InputError(found, "train.share", "give train.share over 0 and train.shift so that both fit")
        lengths = self.bounds[:, 1] - self.bounds[:, 0]
        before = lengths.cumsum(0) - lengths
        low, high = (round(place * int(lengths.sum())) for place in (shift, shift + share))
        first = (low - before).clamp(min=0).minimum(lengths)
        last = (high - before).clamp(min=0).minimum(lengths)
        bounds = self.bounds[:, :1] + torch.stack([first, last], dim=1)
        return replace(self, bounds=bounds[last > first])

    def with_noise(self, share: float, seed: int) -> "Series":
        """Return the same samples with white noise on the inputs.

        Args:
            share: standard deviation of the noise over that of each input; 0: the series itself.
            seed: of the noise.

        Raises:
            InputError: when the share is negative.
        """
        if share < 0.0:
            raise InputError("cannot be negative", "train.noise", "give a share of each input's spread")
        if not share or not len(self):
            return self
        random = torch.Generator().manual_seed(seed)
        noise = torch.randn(self.actions.shape, generator=random, dtype=self.actions.dtype)
        return replace(self, actions=self.actions + share * self.actions.std(0) * noise)

    def split_tail(self, share: float) -> tuple["Series", "Series"]:
        """Return the same samples with each segment ended early, and with its last share alone."""
        first, last = self.bounds.T
        cut = last - ((last - first) * share).long()
        before, after = torch.stack([first, cut], dim=1), torch.stack([cut, last], dim=1)
        return replace(self, bounds=before), replace(self, bounds=after)


def series_of(
    recording: Recording, layout: Layout, runs: Sequence[str], machines: Collection[str] | None = None
) -> Series:
    """Return the series of some runs of a cleaned recording, of all machines of a layout or of some."""
    width = len(layout.states)
    chosen = [columns for name, columns in layout.machines().items() if machines is None or name in machines]
    pieces = [
        _in_step(segment.columns(columns), width, layout.lead)
        for columns in chosen
        for segment in segments(recording, runs)
    ]
    ends = np.cumsum([0, *map(len, pieces)])
    samples = torch.from_numpy(np.concatenate([np.zeros((0, width + len(layout.inputs))), *pieces]))
    return Series(
        states=samples[:, :width],
        actions=samples[:, width:],
        bounds=torch.from_numpy(np.column_stack([ends[:-1], ends[1:]])),
        time_step=recording.time_step,
    )


def _in_step(samples: np.ndarray, width: int, lead: int) -> np.ndarray:
    """Return states (samples, width) and inputs beside them, the inputs taken so many samples later."""
    kept = max(len(samples) - lead, 0)
    return np.concatenate([samples[:kept, :width], samples[lead:, width:]], axis=1)


def gather(series: Tensor, starts: Tensor, length: int) -> Tensor:
    """Return windows (starts, length, ...) of a series (samples, ...), on its device."""
    starts = starts.to(series.device)
    return series[starts[:, None] + torch.arange(length, device=starts.device)]


def evenly(starts: Tensor, most: int) -> Tensor:
    """Return at most so many of the starts, spread evenly."""
    if len(starts) <= most:
        return starts
    return starts[torch.linspace(0, len(starts) - 1, most, dtype=torch.float64).round().long()]
