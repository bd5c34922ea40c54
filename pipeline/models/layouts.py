"""What a learned model sees and predicts of each kind of platform, and what needs no learning.

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
all_steering, of a swerve's recording
    state      steer velocities of all modules
    input      drive velocities, drive and steer voltages
    features   all of them
    predicted  increments of the steer velocities

The first three are taken by the kind of a recording, the others by `train.layout`.
Positions, attitudes and angles follow from the velocities by kinematics, so they are never learned.

Layouts that a person chooses by `train.layout`, all of a quadrotor's recording:

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
motor_setpoint
    state      motor commands
    input      attitude, velocity, body rate, and setpoints of thrust and body rates where they were recorded
    features   body velocity, body rate, setpoints
    predicted  the motor commands themselves
"""

from collections.abc import Mapping
from difflib import get_close_matches
from typing import Any

from simgap.errors import InputError
from simgap.models.all_steering_layout import AllSteeringLayout
from simgap.models.attitude_layout import AttitudeLayout
from simgap.models.joint_layout import JointLayout
from simgap.models.layout import Layout
from simgap.models.motor_command_layout import MotorCommandLayout, MotorSetpointLayout
from simgap.models.quadrotor_layout import QuadrotorLayout
from simgap.models.steering_layout import SteeringLayout
from simgap.models.swerve_chassis_layout import SwerveChassisLayout
from simgap.models.swerve_layout import SwerveLayout
from simgap.recordings.recording import Recording

LAYOUTS: dict[str, type[Layout]] = {
    layout.kind: layout
    for layout in (
        QuadrotorLayout,
        SwerveLayout,
        JointLayout,
        SwerveChassisLayout,
        SteeringLayout,
        AllSteeringLayout,
        AttitudeLayout,
        MotorCommandLayout,
        MotorSetpointLayout,
    )
}


def layout_of(recording: Recording, name: str | None = None) -> Layout:
    """Return the layout through which a recording is seen.

    Args:
        recording: cleaned.
        name: of the layout; None: that of the recording's kind.

    Raises:
        InputError: when there is no such layout, or the recording lacks a column of it.
    """
    name = recording.kind if name is None else name
    if name not in LAYOUTS:
        near = get_close_matches(name, LAYOUTS, n=1)
        remedy = f"did you mean {near[0]!r}?" if near else f"use one of {', '.join(LAYOUTS)}"
        raise InputError(f"there is no layout {name!r}", "train.layout", remedy)
    layout = LAYOUTS[name].of_recording(recording)
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
        return LAYOUTS[str(arguments.pop("kind"))](**arguments)
    except (KeyError, TypeError) as error:
        raise InputError("describes no known platform", "layout", "train the model again") from error
