"""Logs of FRC robots: DataLogManager, AdvantageKit, CTRE's and YAGSL's swerve drives, SysId routines."""

from simgap.logs.log import Log
from simgap.logs.proposal import Proposal
from simgap.logs.wpilog.joint import propose_joint
from simgap.logs.wpilog.swerve import propose_swerve

_FORMAT = "WPILOG"


def propose(log: Log, kind: str | None) -> Proposal | None:
    """Propose a mapping of a WPILib DataLog; None for other formats.

    Args:
        log: as it was read.
        kind: of the platform; None: a single axis where a SysId routine was logged, else a swerve drive, else an axis.
    """
    if log.format != _FORMAT:
        return None
    if kind == "quadrotor":
        return Proposal(
            kind, {}, refusal="a WPILib log is of no quadrotor: give a platform of kind joint or swerve"
        )
    if kind is not None:
        return propose_joint(log) if kind == "joint" else propose_swerve(log)
    joint, swerve = propose_joint(log), propose_swerve(log)
    if joint.is_sure or swerve.refusal:
        return joint
    return swerve
