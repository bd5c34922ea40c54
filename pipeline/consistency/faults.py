"""The list of what may have been done to a recording, by the kind of machine."""

from simgap.consistency.families import Platform, nominal_voltage
from simgap.consistency.joint_faults import joint_faults
from simgap.consistency.plausible import supply_faults
from simgap.consistency.quadrotor_faults import quadrotor_faults
from simgap.consistency.samples import Samples
from simgap.consistency.swerve_faults import swerve_faults
from simgap.consistency.transformation import Transformation
from simgap.platforms.joint import Joint
from simgap.platforms.swerve import Swerve


def faults_of(samples: Samples, platform: Platform | None, sliding: bool) -> list[Transformation]:
    """Return every transformation that is tried.

    Args:
        samples: of the recording.
        platform: where it is known.
        sliding: whether a joint's position is in metres.
    """
    faults = [*supply_faults(samples, nominal_voltage(platform)), *_of_kind(samples, platform, sliding)]
    return [fault for fault in faults if all(name in samples for name in (*fault.columns, *fault.needs))]


def _of_kind(samples: Samples, platform: Platform | None, sliding: bool) -> list[Transformation]:
    if samples.kind == "joint":
        return joint_faults(samples, platform if isinstance(platform, Joint) else None, sliding)
    if samples.kind == "swerve":
        return swerve_faults(samples, platform if isinstance(platform, Swerve) else None)
    return quadrotor_faults(samples)
