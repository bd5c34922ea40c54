"""The swerve drives that two stages use: the identified one, and those of simulators."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from simgap.policies.profile.settings import Profile
from simgap.runner import StageConfig, StageRun

if TYPE_CHECKING:
    from simgap.policies.profile.drive import Drive
    from simgap.policies.profile.driven import Driven

IDENTIFIED = "identified"


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


def policies(task: Profile) -> dict[str, str]:
    """Return the simulators in which policies are trained, by the names of the policies' motions."""
    from simgap.policies.profile.contenders import POLICY

    return {
        POLICY if choice == IDENTIFIED else f"{POLICY}_in_{Path(choice).name}": choice
        for choice in task.simulators
    }


def driven_in(
    choice: str, drive: "Drive", platform: Mapping[str, Any], config: StageConfig, run: StageRun
) -> "Driven":
    """Return what voltages move in a simulator.

    Args:
        choice: `identified`, or a simulator as `chosen_simulator` knows it.
        drive: identified.
        platform: whose own dynamics an ideal simulator is.
        config: of the stage.
        run: of the stage.

    Raises:
        InputError: when there is no such simulator, or it is not of a swerve drive.
    """
    from simgap.policies.profile.driven import LinearDrive, SimulatedDrive
    from simgap.stages._simulators import chosen_simulator

    if choice == IDENTIFIED:
        return LinearDrive(drive)
    return SimulatedDrive(chosen_simulator(choice, platform, config, run)[0], drive)
