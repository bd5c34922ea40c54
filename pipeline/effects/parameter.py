"""A number that an effect is fitted by."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

from simgap.effects.sizes import multiple_of, size_of


@dataclass(frozen=True)
class Parameter:
    """A parameter of an effect.

    Attributes:
        name: full word.
        unit: as written in the diagnosis.
        default: a realistic size, in `unit`.
        low: least value that physics allows.
        high: greatest plausible value.
        neutral: the value at which the effect does nothing.
        optional: whether it is neutral where only the others are given, as in a simulator written before it was there.
        typical: whether machines that have the effect have it about as large as the default, a decade either way.
        alike: whether it is as large on small machines as on large ones, though its unit is that of a size.
    """

    name: str
    unit: str
    default: float
    low: float
    high: float
    neutral: float = 0.0
    optional: bool = False
    typical: bool = False
    alike: bool = False

    @property
    def is_limit(self) -> bool:
        """Whether the effect does nothing where the value is too great to be reached."""
        return self.neutral == self.high

    def usual_in(self, sizes: Mapping[str, float]) -> float:
        """Return a realistic size, in `unit`, for a machine of the given multiples of the usual sizes."""
        return abs(self.default) * (1.0 if self.alike else multiple_of(self.unit, sizes))

    def size_in(self, sizes: Mapping[str, float]) -> float:
        """Return the factor on its numbers for a machine of these sizes; see `simgap.effects.sizes`."""
        return 1.0 if self.alike else size_of(self.unit, sizes)

    def of_size(self, sizes: Mapping[str, float]) -> "Parameter":
        """Return the parameter of a machine of these sizes."""
        size = self.size_in(sizes)
        numbers = {name: size * getattr(self, name) for name in ("default", "low", "high", "neutral")}
        return replace(self, **numbers)
