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
    supply = supply_faults(samples, nominal_voltage(platform))
    if samples.kind == "joint":
        return supply + joint_faults(samples, platform if isinstance(platform, Joint) else None, sliding)
    if samples.kind == "swerve":
        return supply + swerve_faults(samples, platform if isinstance(platform, Swerve) else None)
    return supply + quadrotor_faults(samples)
