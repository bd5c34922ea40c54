"""Which mechanism belongs to which platform."""

from pipeline.platforms.joint import Joint
from pipeline.platforms.joint_mechanism import JointMechanism
from pipeline.platforms.mechanism import Mechanism
from pipeline.platforms.quadrotor import Quadrotor
from pipeline.platforms.quadrotor_mechanism import QuadrotorMechanism
from pipeline.platforms.swerve import Swerve
from pipeline.platforms.swerve_mechanism import SwerveMechanism


def mechanism_of(platform: Quadrotor | Swerve | Joint, position_unit: str = "rad") -> Mechanism:
    """Return the nominal mechanism of a platform; `position_unit` (rad or m) matters to a joint only."""
    if isinstance(platform, Quadrotor):
        return QuadrotorMechanism(platform)
    if isinstance(platform, Swerve):
        return SwerveMechanism(platform)
    return JointMechanism(platform, position_unit)
