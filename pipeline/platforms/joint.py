"""Joint: a single rotary or sliding axis."""

from dataclasses import dataclass
from typing import ClassVar


@dataclass(frozen=True)
class JointMotor:
    """A brushed or field-oriented motor behind a gear.

    Attributes:
        resistance: Ω.
        torque_constant: N·m/A, equal to the back-EMF constant in V/(rad/s).
        gear_ratio: motor turns per joint turn (rad/m for a sliding axis).
    """

    resistance: float
    torque_constant: float
    gear_ratio: float = 1.0


@dataclass(frozen=True)
class Joint:
    """A single axis; its unit of position is rad or m.

    Attributes:
        inertia: kg·m² or kg.
        gravity_torque: m·g·l, N·m; the nominal model has −gravity_torque·sin(position).
        stiffness: N·m/rad or N/m; the nominal model has −stiffness·position.
        motor: needed where the input is a voltage.
        gravity: m/s².
    """

    kind: ClassVar[str] = "joint"

    inertia: float
    gravity_torque: float = 0.0
    stiffness: float = 0.0
    motor: JointMotor | None = None
    gravity: float = 9.81
