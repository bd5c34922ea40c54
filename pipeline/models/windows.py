"""Windows over recorded series, by index: the samples stay in one tensor and are gathered per batch."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np
import torch
from torch import Tensor

from pipeline.models.layout import Layout
from pipeline.models.segments import segments
from pipeline.recordings.recording import Recording


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

    def starts(self, length: int) -> Tensor:
        """Return the first sample of every window of `length` samples that stays inside one segment."""
        pieces = [torch.arange(first, max(last - length + 1, first)) for first, last in self.bounds.tolist()]
        return torch.cat(pieces) if pieces else torch.zeros(0, dtype=torch.long)

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
    pieces = [segment.columns(columns) for columns in chosen for segment in segments(recording, runs)]
    ends = np.cumsum([0, *map(len, pieces)])
    samples = torch.from_numpy(np.concatenate([np.zeros((0, width + len(layout.inputs))), *pieces]))
    return Series(
        states=samples[:, :width],
        actions=samples[:, width:],
        bounds=torch.from_numpy(np.column_stack([ends[:-1], ends[1:]])),
        time_step=recording.time_step,
    )


def gather(series: Tensor, starts: Tensor, length: int) -> Tensor:
    """Return windows (starts, length, ...) of a series (samples, ...)."""
    return series[starts[:, None] + torch.arange(length, device=starts.device)]


def evenly(starts: Tensor, most: int) -> Tensor:
    """Return at most so many of the starts, spread evenly."""
    if len(starts) <= most:
        return starts
    return starts[torch.linspace(0, len(starts) - 1, most, dtype=torch.float64).round().long()]
