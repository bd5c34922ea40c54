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
class Controller:
    """The position loop of a servo: effort = proportional · (command − position) − derivative · velocity, limited.

    Attributes:
        proportional: N·m/rad or N/m; None where it is unknown.
        derivative: N·m·s/rad or N·s/m; None where it is unknown.
        effort_limit: greatest effort, N·m or N; None where it is unknown, and then there is none.
        proportional_std: standard error of a gain that was identified from a recording; None where it was given.
        derivative_std: the same.
    """

    proportional: float | None = None
    derivative: float | None = None
    effort_limit: float | None = None
    proportional_std: float | None = None
    derivative_std: float | None = None

    @property
    def given(self) -> tuple[str, ...]:
        """The gains that a person gave."""
        return tuple(
            name for name in GAINS if getattr(self, name) is not None and getattr(self, f"{name}_std") is None
        )

    @property
    def unknown(self) -> tuple[str, ...]:
        """The gains that nobody knows."""
        return tuple(name for name in GAINS if getattr(self, name) is None)


GAINS = ("proportional", "derivative")


@dataclass(frozen=True)
class Joint:
    """A single axis; its unit of position is rad or m.

    Attributes:
        inertia: kg·m² or kg.
        gravity_torque: m·g·l, N·m; the nominal model has −gravity_torque·sin(position).
        stiffness: N·m/rad or N/m; the nominal model has −stiffness·position.
        motor: needed where the input is a voltage.
        gravity: m/s².
        controller: of a servo that is told a position.
    """

    kind: ClassVar[str] = "joint"

    inertia: float
    gravity_torque: float = 0.0
    stiffness: float = 0.0
    motor: JointMotor | None = None
    gravity: float = 9.81
    controller: Controller | None = None
