"""Linear bias correction of predictions: true = slope · predicted + offset, for each target.

Networks with dropout and early stopping predict increments that are too small or biased. A line of true over predicted
increments, fitted on other runs, removes this error.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from torch import Tensor


@dataclass(frozen=True)
class BiasCorrection:
    """A linear correction of each target.

    Attributes:
        slope: true over predicted increment, (targets,).
        offset: true increment where none is predicted, (targets,), in the target's unit.
    """

    slope: tuple[float, ...]
    offset: tuple[float, ...]

    @classmethod
    def fit(cls, predicted: Tensor, true: Tensor) -> "BiasCorrection":
        """Fit by least squares to increments (samples, targets); what never varies keeps a slope of one."""
        deviation = predicted - predicted.mean(0)
        variance = deviation.square().sum(0)
        slope = (deviation * true).sum(0) / variance
        slope = slope.where(variance > 0, slope.new_ones(()))
        offset = true.mean(0) - slope * predicted.mean(0)
        return cls(tuple(slope.tolist()), tuple(offset.tolist()))

    def as_mapping(self) -> dict[str, list[float]]:
        """Return the plain mapping from which the same correction is built."""
        return {"slope": list(self.slope), "offset": list(self.offset)}

    @classmethod
    def from_mapping(cls, values: Mapping[str, Sequence[float]], targets: int) -> "BiasCorrection":
        """Return the correction that `as_mapping` described.

        Raises:
            KeyError: when slope or offset is missing.
            ValueError: when they are no finite numbers, one for each target.
        """
        slope, offset = (tuple(map(float, values[key])) for key in ("slope", "offset"))
        if not len(slope) == len(offset) == targets or not all(map(math.isfinite, slope + offset)):
            raise ValueError("a correction needs a slope and an offset for each target")
        return cls(slope, offset)

    def apply(self, increments: Tensor) -> Tensor:
        """Return corrected increments (..., targets)."""
        return increments * increments.new_tensor(self.slope) + increments.new_tensor(self.offset)
