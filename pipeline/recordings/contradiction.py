"""A recording that contradicts itself or the platform: which column, what is suspected, and the remedy."""

from dataclasses import dataclass

SUSPECTED = {
    "sign": "another sign or frame",
    "degrees": "degrees instead of radians",
    "rotations": "rotations instead of radians",
    "turns_per_minute": "turns per minute instead of rad/s",
    "millimetres": "millimetres instead of metres",
    "centimetres": "centimetres instead of metres",
    "feet": "feet instead of metres",
    "inches": "inches instead of metres",
    "per_minute": "a rate per minute instead of per second",
    "counts": "a sensor that counts half or double",
    "milli": "thousandths of the unit",
    "centi": "hundredths of the unit",
    "g_units": "multiples of g instead of m/s²",
    "duty": "a duty instead of a voltage",
    "percent": "percent",
    "full_scale": "whole numbers of a full scale",
    "pulse_width": "a pulse width in µs",
    "thrust_command": "a command of thrust instead of speed",
    "per_cell": "the voltage of one cell",
    "time_unit": "another unit of time",
    "gear_ratio": "the other side of the gear",
    "wheel_speed": "the speed of the wheel on the ground",
    "motor_order": "another order of the motors",
    "axis_order": "another order of the axes",
    "quaternion_order": "another order of the quaternion",
    "conjugate": "the inverse rotation",
    "frame": "another frame",
    "body_frame": "a vector of another frame",
    "missing_gravity": "an acceleration without gravity",
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
