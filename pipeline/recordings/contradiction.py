"""A recording that contradicts itself or the platform: which column, what is suspected, and the remedy."""

from dataclasses import dataclass

SUSPECTED = {
    "sign": "another sign or frame",
    "degrees": "degrees instead of radians",
    "millimetres": "millimetres instead of metres",
    "turns_per_minute": "turns per minute instead of rad/s",
    "motor_order": "another order of the motors, or another sign",
    "unit": "another unit or scale",
}
"""What may have been done to a column, in words, by the names that `suspected` takes."""


@dataclass(frozen=True)
class Contradiction:
    """One contradiction.

    Attributes:
        column: of the recording; a group of them as `motor_speed_1..4`.
        suspected: a key of `SUSPECTED`.
        evidence: what contradicts what, with figures; no full stop.
        remedy: what to do, a sentence.
        runs: in which it was seen.
    """

    column: str
    suspected: str
    evidence: str
    remedy: str
    runs: tuple[str, ...] = ()

    @property
    def sentence(self) -> str:
        """All of it in one line."""
        return f"{self.evidence}: {SUSPECTED[self.suspected]}? {self.remedy}"
