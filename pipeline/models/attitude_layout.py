"""Inputs and targets of a learned model of a quadrotor's attitude control."""

from dataclasses import dataclass
from typing import ClassVar

from torch import Tensor

from simgap.models.rate_layout import RateLayout
from simgap.recordings.recording import Recording


@dataclass(frozen=True)
class AttitudeLayout(RateLayout):
    """From commanded to true body rates, axis by axis: the quantity that a pilot's stick commands.

    Angles are left out: they follow from the rates by kinematics, which needs no learning.
    """

    kind: ClassVar[str] = "attitude"
    states: ClassVar[tuple[str, ...]] = tuple(f"body_rate_{axis}" for axis in "xyz")

    @classmethod
    def of_recording(cls, recording: Recording) -> "AttitudeLayout":
        """Every recording with commanded body rates has the same columns."""
        return cls(tuple(f"body_rate_command_{axis}" for axis in "xyz"))

    def errors(self, predicted: Tensor, true: Tensor) -> dict[str, Tensor]:
        """Absolute differences by axis, rad/s."""
        difference = (predicted - true).abs()
        return {
            name: difference[..., index] for index, name in enumerate(("roll_rate", "pitch_rate", "yaw_rate"))
        }
