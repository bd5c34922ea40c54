"""Floor 2: platforms, the known parameters of a machine before identification."""

from simgap.platforms.joint import Controller, Joint, JointMotor
from simgap.platforms.load import (
    plain_config,
    platform_assumptions,
    platform_from_config,
    platform_to_config,
)
from simgap.platforms.quadrotor import Quadrotor
from simgap.platforms.swerve import DirectCurrentMotor, SteerAxis, Swerve, SwerveAxis

Platform = Quadrotor | Swerve | Joint

__all__ = [
    "Controller",
    "DirectCurrentMotor",
    "Joint",
    "JointMotor",
    "Platform",
    "Quadrotor",
    "SteerAxis",
    "Swerve",
    "SwerveAxis",
    "plain_config",
    "platform_assumptions",
    "platform_from_config",
    "platform_to_config",
]
