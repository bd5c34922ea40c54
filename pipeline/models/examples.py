"""Training examples: windows of features and the increments that follow them."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import torch
from torch import Tensor

from simgap.errors import InputError
from simgap.models.layout import Layout
from simgap.models.scaling import Scaler
from simgap.models.windows import Series, evenly, gather

_CHUNK = 4096

Physics = Callable[[Tensor, Tensor], Tensor]
"""From states (batch, states) and inputs (batch, inputs) to the next states by a simulator's physics."""


@dataclass(frozen=True)
class Examples:
    """Windows by index.

    Attributes:
        features: (samples, features).
        targets: increment from each sample to the next, or what physics leave of it, (samples, targets).
        starts: first samples of the windows that are followed by a sample of the same segment, (windows,).
        length: of a window.
    """

    features: Tensor
    targets: Tensor
    starts: Tensor
    length: int

    def __len__(self) -> int:
        return len(self.starts)

    @classmethod
    def of_series(
        cls, series: Series, layout: Layout, length: int, what: str, physics: Physics | None = None
    ) -> "Examples":
        """Encode a series.

        Args:
            series: the samples.
            layout: how they are seen.
            length: of a window.
            what: what the series is for, to be named in the error.
            physics: whose increments are taken off the targets.

        Raises:
            InputError: when no segment is long enough for a window and the sample after it.
        """
        if length < 1:
            raise InputError("must be at least 1", "model.sequence_length", "give a number of samples")
        starts = series.starts(length + 1)
        if not len(starts):
            remedy = "shorten it, or record longer without gaps"
            raise InputError(f"no {what} segment holds {length + 1} samples", "model.sequence_length", remedy)
        following = torch.roll(series.states, -1, dims=0)  # the last row of a segment is never a target
        targets = layout.increment(series.states, following)
        if physics is not None:
            targets = targets - layout.increment(series.states, physics(series.states, series.actions))
        return cls(
            features=layout.encode(series.states, series.actions),
            targets=targets,
            starts=starts,
            length=length,
        )

    def to(self, device: torch.device) -> "Examples":
        """Return the same windows on a device."""
        features, targets, starts = (part.to(device) for part in (self.features, self.targets, self.starts))
        return replace(self, features=features, targets=targets, starts=starts)

    def at_most(self, windows: int | None) -> "Examples":
        """Return so many of the validation windows at most, spread evenly; all where there is no limit.

        Raises:
            InputError: when that leaves none.
        """
        if windows is None:
            return self
        if windows < 1:
            raise InputError(
                "needs at least one", "train.validation_windows", "give a positive number, or null"
            )
        return replace(self, starts=evenly(self.starts, windows))

    def seen(self) -> Tensor:
        """Return the samples (n,) that are the last of some window: those whose targets are real."""
        return self.starts + self.length - 1

    def take(self, index: Tensor) -> tuple[Tensor, Tensor]:
        """Return windows (batch, length, features) and targets (batch, targets)."""
        starts = self.starts[index.to(self.starts.device)]
        return gather(self.features, starts, self.length), self.targets[starts + self.length - 1]

    def chunks(self) -> Iterator[tuple[Tensor, Tensor]]:
        """Yield all windows and targets, some thousand at a time."""
        return map(self.take, torch.arange(len(self)).split(_CHUNK))

    def spread(self) -> Tensor:
        """Return the standard deviation of the targets that are seen, (targets,)."""
        return Scaler.fit(self.targets[self.seen()], "standard").spread


@torch.no_grad()
def one_step_loss(increments: Callable[[Tensor], Tensor], train: Examples, held: Examples) -> float:
    """Return the mean squared error of increments on held examples, each scaled by its spread in training."""
    squared = [
        ((increments(windows) - targets) / train.spread()).square().mean(1)
        for windows, targets in held.chunks()
    ]
    return float(torch.cat(squared).mean())
