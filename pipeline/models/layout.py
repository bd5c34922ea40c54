"""What a layout can do: it says what a learned model sees and predicts, and what needs no learning.

The layouts themselves stand in files of their own; `simgap.models.layouts` lists them.
"""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any, ClassVar

from torch import Tensor

from simgap.recordings.recording import Recording


@dataclass(frozen=True)
class Layout(ABC):
    """The columns of states and inputs, and the functions between states, features and increments.

    All functions take tensors with free leading dimensions and work in their precision.

    Attributes:
        inputs: columns of the recording that drive the machine.
        lead: samples by which the inputs of a step are recorded later than the state at its beginning.
    """

    kind: ClassVar[str]
    states: ClassVar[tuple[str, ...]]
    moved: ClassVar[tuple[tuple[str, ...], ...]] = ()
    """Quantities of the states that move together, where a network of its own may predict each such group."""
    inputs: tuple[str, ...]
    lead: int = field(default=0, kw_only=True)

    @property
    @abstractmethod
    def features(self) -> tuple[str, ...]:
        """Names of what `encode` returns; what comes of the inputs stands last."""

    @property
    def input_features(self) -> int:
        """How many of the features come of the inputs."""
        return len(self.inputs)

    @property
    @abstractmethod
    def targets(self) -> tuple[str, ...]:
        """Names of what `increment` returns: those of the states that move by them."""

    def machines(self) -> dict[str, tuple[str, ...]]:
        """Return the recorded columns of states and inputs, by the suffix that tells machines of one kind apart.

        Most layouts see all that was recorded as one machine.
        """
        return {"": (*self.states, *self.inputs)}

    @classmethod
    @abstractmethod
    def of_recording(cls, recording: Recording) -> "Layout":
        """Return the layout of what was recorded."""

    def on(self, platform: Mapping[str, Any]) -> "Layout":
        """Return the layout with what it needs to know of the platform's configuration; most need nothing."""
        return self

    @abstractmethod
    def encode(self, state: Tensor, action: Tensor) -> Tensor:
        """Return the features (..., features) of states (..., states) and inputs (..., inputs)."""

    def regressors(self, features: Tensor) -> Tensor:
        """Return the features, and the products in which a state space is linear as well, (..., regressors)."""
        return features

    @abstractmethod
    def increment(self, state: Tensor, following: Tensor) -> Tensor:
        """Return the increments (..., targets) from states to the next ones."""

    @abstractmethod
    def advance(self, state: Tensor, increment: Tensor, time_step: float) -> Tensor:
        """Return the next states, (..., states); the inverse of `increment`, completed by kinematics.

        Args:
            state: (..., states).
            increment: (..., targets).
            time_step: s.
        """

    @abstractmethod
    def errors(self, predicted: Tensor, true: Tensor) -> dict[str, Tensor]:
        """Return the size (...) of the difference of states by quantity, in the quantity's unit."""

    def as_mapping(self) -> dict[str, Any]:
        """Return the plain mapping from which `layout_from_mapping` builds the same layout."""
        values = {
            key: list(value) if isinstance(value, tuple) else value for key, value in asdict(self).items()
        }
        return {"kind": self.kind} | values
