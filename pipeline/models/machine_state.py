"""Between the state of a simulated machine and that of a layout: which layouts can move a simulator, and how."""

from typing import ClassVar

import torch
from jaxtyping import Float
from torch import Tensor

from simgap.errors import InputError
from simgap.models.layout import Layout
from simgap.models.swerve_layout import four
from simgap.physics.shapes import Signals
from simgap.platforms import Platform, Swerve
from simgap.platforms.swerve_mechanism import SwerveMechanism, twist_from_wheels
from simgap.simulation.motion import SwerveMotion

_SIGNALS = {"motor_speed": "rotor_speed"}  # names of signals where they are not those of the columns
_TWIST, _ANGLE, _STEER, _HEADING = (
    SwerveMotion.parts[name] for name in ("chassis_velocity", "steer_angle", "steer_velocity", "heading")
)


class MachineState:
    """A layout whose states are those of the machine's motion, in the same order.

    Attributes:
        kind: of the platform.
        kept: signals that the layout has as states and the motion has not; a simulation remembers them.
    """

    kind: str
    kept: ClassVar[tuple[str, ...]] = ()

    def __init__(self, platform: Platform) -> None:
        self.kind = platform.kind

    def seen(self, state: Float[Tensor, "*batch n"], signals: Signals) -> Float[Tensor, "*batch states"]:
        """Return the layout's states: of the motion's (..., n), and of the signals that are `kept`."""
        return state

    def reached(
        self, own: Float[Tensor, "*batch states"], before: Float[Tensor, "*batch n"], time_step: float
    ) -> Float[Tensor, "*batch n"]:
        """Return the motion's state, (..., n), after a step from `before` to the layout's states."""
        return own

    def kept_of(self, own: Float[Tensor, "*batch states"]) -> dict[str, Tensor]:
        """Return the signals that are `kept`, by name."""
        return {}


class SwerveChassisState(MachineState):
    """Chassis and modules; the drive motors' speeds are kept, for a wheel may slip."""

    kept = ("drive_velocity",)
    parts: ClassVar = {
        "twist": slice(0, 3),
        "drive": slice(3, 7),
        "steer": slice(7, 11),
        "angle": slice(11, 15),
    }

    def __init__(self, platform: Platform) -> None:
        super().__init__(platform)
        assert isinstance(platform, Swerve)
        self.platform = platform

    def seen(self, state: Float[Tensor, "*batch 12"], signals: Signals) -> Float[Tensor, "*batch states"]:
        """Return twist, drive velocities, steer velocities and angles, in the layout's order."""
        named = {
            "twist": state[..., _TWIST],
            "drive": signals["drive_velocity"],
            "steer": state[..., _STEER],
            "angle": state[..., _ANGLE],
        }
        return torch.cat([named[name] for name in self.parts], dim=-1)

    def reached(
        self, own: Float[Tensor, "*batch states"], before: Float[Tensor, "*batch 12"], time_step: float
    ) -> Float[Tensor, "*batch 12"]:
        """Return the motion's state; the heading turns with the mean of the rates at both ends."""
        twist, angle, steer = self._twist(own), own[..., self.parts["angle"]], own[..., self.parts["steer"]]
        turned = 0.5 * time_step * (before[..., _TWIST] + twist)[..., 2:]
        return torch.cat([twist, angle, steer, before[..., _HEADING] + turned], dim=-1)

    def kept_of(self, own: Float[Tensor, "*batch states"]) -> dict[str, Tensor]:
        """Return the drive velocities."""
        return {"drive_velocity": own[..., self.parts["drive"]]}

    def _twist(self, own: Tensor) -> Tensor:
        return own[..., self.parts["twist"]]


class SwerveState(SwerveChassisState):
    """Modules alone: the chassis moves as their wheels roll."""

    parts: ClassVar = {"drive": slice(0, 4), "steer": slice(4, 8), "angle": slice(8, 12)}

    def _twist(self, own: Tensor) -> Tensor:
        names = {"drive_velocity": "drive", "steer_velocity": "steer", "steer_angle": "angle"}
        wheels = {name: own[..., self.parts[part]] for name, part in names.items()}
        return twist_from_wheels(wheels, SwerveMechanism(self.platform).constants())


_STATES: dict[str, tuple[str, type[MachineState]]] = {
    "quadrotor": ("quadrotor", MachineState),
    "joint": ("joint", MachineState),
    "swerve": ("swerve", SwerveState),
    "swerve_chassis": ("swerve", SwerveChassisState),
}
"""Layouts that can move a simulator, with the kind of its platform."""


def machine_state(layout: Layout, platform: Platform, key: str = "dynamics") -> MachineState:
    """Return how the states of a layout and of a platform's motion belong together.

    Args:
        layout: of a model.
        platform: of a simulator.
        key: of the configuration that asks for it.

    Raises:
        InputError: when a model of the layout cannot move a simulator of the platform.
    """
    kind, state = _STATES.get(layout.kind, ("", MachineState))
    if kind != platform.kind:
        able = " or ".join(name for name, (of, _) in _STATES.items() if of == platform.kind)
        found = f"a model of the layout {layout.kind!r} cannot move the simulator of a {platform.kind}"
        raise InputError(found, f"simulator.{key}", f"train one with train.layout={able}")
    return state(platform)


def input_signals(layout: Layout) -> tuple[str, ...]:
    """Return the signals that a layout's inputs are the components of, in their order."""
    stems = dict.fromkeys(name.rstrip("0123456789").rstrip("_") for name in layout.inputs)
    for stem in stems:
        assert stem in layout.inputs or set(four(stem)) <= set(layout.inputs)
    return tuple(_SIGNALS.get(stem, stem) for stem in stems)
