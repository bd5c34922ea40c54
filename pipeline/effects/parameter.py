"""A number that an effect is fitted by."""

from dataclasses import dataclass, replace


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
    """

    name: str
    unit: str
    default: float
    low: float
    high: float
    neutral: float = 0.0
    optional: bool = False
    typical: bool = False

    @property
    def is_limit(self) -> bool:
        """Whether the effect does nothing where the value is too great to be reached."""
        return self.neutral == self.high

    def times(self, size: float) -> "Parameter":
        """Return the parameter of a machine that many times as large."""
        numbers = {name: size * getattr(self, name) for name in ("default", "low", "high", "neutral")}
        return replace(self, **numbers)
