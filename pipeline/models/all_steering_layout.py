"""Inputs and targets of a learned model of all steering motors of a swerve drive together."""

from dataclasses import dataclass
from typing import ClassVar

import torch
from torch import Tensor

from simgap.models.rate_layout import RateLayout
from simgap.models.swerve_layout import four
from simgap.recordings.recording import Recording


@dataclass(frozen=True)
class AllSteeringLayout(RateLayout):
    """States: the four steer velocities. Inputs: the voltages of all eight motors and the four drive velocities.

    As published ("Beyond linear horizons"): the network sees all eight motors and gives the next four steer velocities.
    The drive velocities are recorded, also over many steps.
    """

    kind: ClassVar[str] = "all_steering"
    states: ClassVar[tuple[str, ...]] = four("steer_velocity")

    @classmethod
    def of_recording(cls, recording: Recording) -> "AllSteeringLayout":
        """Every swerve recording has the same columns."""
        return cls((*four("drive_velocity"), *four("drive_voltage"), *four("steer_voltage")))

    def errors(self, predicted: Tensor, true: Tensor) -> dict[str, Tensor]:
        """Euclidean norm over the four modules, rad/s."""
        return {"steer_velocity": torch.linalg.vector_norm(predicted - true, dim=-1)}
