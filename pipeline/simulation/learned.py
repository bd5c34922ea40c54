"""What a simulator asks of a learned model of its machine's motion.

A simulator's `dynamics` are its physics or a learned model; its `residual` is a learned model of what the physics
leaves. The model itself stands in `simgap.models`, above this package.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from pathlib import Path
from typing import Any, ClassVar

from jaxtyping import Float
from torch import Tensor

from simgap.errors import InputError
from simgap.physics.shapes import Signals
from simgap.platforms import Platform

DYNAMICS, RESIDUAL = "dynamics", "residual"
PHYSICS_SUBSTEPS = 4
"""Integration steps of the physics under a residual: the residual belongs to them, in training and in simulation."""


class Learned(ABC):
    """The learned part of a simulator.

    Attributes:
        role: `dynamics`, the whole motion, or `residual`, what the physics leaves of it.
        time_step: between the samples that it has learned from, s.
        inputs: signals that drive it, by name.
    """

    folder: ClassVar[str] = "learned"
    role: str
    time_step: float
    inputs: tuple[str, ...]

    @abstractmethod
    def begin(self, signals: Signals) -> Any:
        """Return what is remembered when a simulation goes on from recorded samples.

        Args:
            signals: up to the sample at which it begins, (batch, samples, ...).
        """

    @abstractmethod
    def follow(
        self,
        state: Float[Tensor, "batch n"],
        signals: Signals,
        memory: Any,
        physics: Float[Tensor, "batch n"] | None = None,
    ) -> tuple[Float[Tensor, "batch n"], Any]:
        """Return the state a time step later, and the memory for the next one.

        Args:
            state: of the machine's motion, see `simgap.simulation.motion`.
            signals: `inputs`, held over the step, (batch, ·) each.
            memory: of the step before; None: the machine has always been as it is.
            physics: where the physics lead; None: they are not asked.
        """

    @abstractmethod
    def describe(self) -> dict[str, Any]:
        """Return what a person is told of the model, plain values by name."""

    @abstractmethod
    def save(self, folder: Path) -> None:
        """Write the model; the same model gives the same bytes."""

    def steps_in(self, duration: float) -> int:
        """Return how many of its steps a duration, s, holds.

        Raises:
            InputError: when it is no whole number of them.
        """
        steps = round(duration / self.time_step)
        if steps < 1 or not math.isclose(steps * self.time_step, duration, rel_tol=1e-3):
            found = (
                f"a step of {duration:g} s is no multiple of the {self.time_step:g} s that it learned from"
            )
            raise InputError(
                found, "the learned simulator", "change the period, or the rate of the recording"
            )
        return steps


LearnedReader = Callable[[Path, Platform, str], Learned]
"""From the folder that `Learned.save` wrote, the platform and the role to the learned part of a simulator."""
