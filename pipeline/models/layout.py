"""Layouts of learned models: state, input, features and predicted increments for each kind of platform.

quadrotor
    state      position, attitude, velocity, body rate
    input      motor speeds, or commands where no speeds were recorded
    features   body velocity, direction of gravity in the body frame, body rate, squared input
    predicted  increments of velocity (in the body frame of the step's beginning) and of body rate
swerve
    state      drive velocities, steer velocities, steer angles
    input      drive and steer voltages
    features   velocities, cosine and sine of the steer angles, voltages
    predicted  increments of drive and steer velocities
joint
    state      position, velocity
    input      voltage, or effort where no voltage was recorded
    features   sine and cosine of the position (of a sliding joint the position), velocity, input
    predicted  increment of velocity

swerve_chassis, of a swerve's recording
    state      chassis velocity and rate, drive velocities, steer velocities, steer angles
    input      drive and steer voltages
    features   velocities, cosine and sine of the steer angles, voltages
    predicted  increments of all velocities
steering, of a swerve's recording, whose four modules are machines of one kind
    state      steer velocity
    input      steer voltage
    features   velocity and its sign, voltage
    predicted  increment of the steer velocity

The first three are taken by the kind of a recording, the others by `train.layout`.
Positions, attitudes and angles follow from the velocities by kinematics, so they are never learned.

Layouts that a person chooses by `train.layout`, both of a quadrotor's recording:

attitude
    state      body rates
    input      commanded body rates
    features   both
    predicted  increments of the body rates
motor_command
    state      motor commands
    input      attitude, velocity, body rate, and specific force and battery voltage where they were recorded
    features   the air's velocity at every rotor, body rate, specific force, battery voltage
    predicted  the motor commands themselves
"""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from difflib import get_close_matches
from typing import Any, ClassVar

from torch import Tensor

from simgap.errors import InputError
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


def layout_of(recording: Recording, name: str | None = None) -> Layout:
    """Return the layout of a recording.

    Args:
        recording: cleaned.
        name: of the layout; None: that of the recording's kind.

    Raises:
        InputError: when there is no such layout, or the recording lacks a column of it.
    """
    layouts = _layouts()
    name = recording.kind if name is None else name
    if name not in layouts:
        near = get_close_matches(name, layouts, n=1)
        remedy = f"did you mean {near[0]!r}?" if near else f"use one of {', '.join(layouts)}"
        raise InputError(f"there is no layout {name!r}", "train.layout", remedy)
    layout = layouts[name].of_recording(recording)
    columns = (column for machine in layout.machines().values() for column in machine)
    missing = [column for column in columns if column not in recording.frame]
    if missing:
        found = f"the layout {name!r} needs the column {missing[0]!r}, which was not recorded"
        raise InputError(found, "train.layout", "choose another layout, or none")
    return layout


def layout_from_mapping(values: Mapping[str, Any]) -> Layout:
    """Return the layout that `Layout.as_mapping` described.

    Raises:
        InputError: when it describes none.
    """
    arguments: dict[str, Any] = {
        key: tuple(value) if isinstance(value, list) else value for key, value in values.items()
    }
    try:
        return _layouts()[str(arguments.pop("kind"))](**arguments)
    except (KeyError, TypeError) as error:
        raise InputError("describes no known platform", "layout", "train the model again") from error


def _layouts() -> dict[str, type[Layout]]:
    from simgap.models.attitude_layout import AttitudeLayout
    from simgap.models.joint_layout import JointLayout
    from simgap.models.motor_command_layout import MotorCommandLayout
    from simgap.models.quadrotor_layout import QuadrotorLayout
    from simgap.models.steering_layout import SteeringLayout
    from simgap.models.swerve_chassis_layout import SwerveChassisLayout
    from simgap.models.swerve_layout import SwerveLayout

    layouts = (
        QuadrotorLayout,
        SwerveLayout,
        JointLayout,
        SwerveChassisLayout,
        SteeringLayout,
        AttitudeLayout,
        MotorCommandLayout,
    )
    return {layout.kind: layout for layout in layouts}
