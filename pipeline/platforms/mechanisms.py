"""Choice of the mechanism for a platform."""

from simgap.platforms.joint import Joint
from simgap.platforms.joint_mechanism import JointMechanism
from simgap.platforms.mechanism import Mechanism
from simgap.platforms.quadrotor import Quadrotor
from simgap.platforms.quadrotor_mechanism import QuadrotorMechanism
from simgap.platforms.swerve import Swerve
from simgap.platforms.swerve_mechanism import SwerveMechanism


def mechanism_of(platform: Quadrotor | Swerve | Joint, position_unit: str = "rad") -> Mechanism:
    """Return the nominal mechanism of a platform; `position_unit` (rad or m) matters to a joint only."""
    if isinstance(platform, Quadrotor):
        return QuadrotorMechanism(platform)
    if isinstance(platform, Swerve):
        return SwerveMechanism(platform)
    return JointMechanism(platform, position_unit)
