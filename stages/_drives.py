"""The identified swerve drive that two stages use."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from simgap.policies.profile.settings import Profile
from simgap.runner import StageConfig, StageRun

if TYPE_CHECKING:
    from simgap.policies.profile.drive import Drive


def identified(platform: Mapping[str, Any], task: Profile, config: StageConfig, run: StageRun) -> "Drive":
    """Return the drive as `sysid` of the same branch identified it, for motion straight ahead.

    Raises:
        InputError: when the platform is no swerve drive, or something is not known of its motors.
    """
    from simgap.errors import InputError
    from simgap.platforms import Swerve, platform_from_config
    from simgap.policies.profile.identified import identified_drive

    swerve = platform_from_config(platform)
    if not isinstance(swerve, Swerve):
        raise InputError("is not a swerve drive", "platform", "choose platform=swerve_shuttle or another one")
    path = run.input(config.artifact("sysid", "parameters.yaml"))
    return identified_drive(path, swerve, task.voltage_limit, task.acceleration_limit)
