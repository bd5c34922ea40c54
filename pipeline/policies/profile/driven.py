"""What a straight drive moves by: the identified law of its motors, or a simulator, physical or learned."""

import math
from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

import torch
from torch import Tensor
from torch.utils import _pytree as tree

from simgap.errors import InputError
from simgap.platforms import Swerve
from simgap.policies.profile.drive import Drive
from simgap.simulation import Simulator, step
from simgap.simulation.driver import without_driver
from simgap.simulation.motion import SwerveMotion

VELOCITY = "velocity"
_MOTION, _MEMORY = "motion", "memory_"
_LONGEST_STEP = 0.005  # s, of the integration of physics
_STATE_SIZE = SwerveMotion.parts["heading"].stop
_FORWARD = SwerveMotion.parts["chassis_velocity"].start

State = dict[str, Tensor]
"""What changes of a batch of drives, by name, the batch leading; `velocity` is the wheels', m/s on the ground."""


@runtime_checkable
class Driven(Protocol):
    """A batch of drives straight ahead."""

    def begin(self, velocity: Tensor) -> State:
        """Return the state of drives that have always rolled at a velocity, (batch, wheels) m/s."""

    def advance(self, state: State, voltage: Tensor, period: float) -> tuple[State, Tensor]:
        """Return the state after a voltage was held, and the way that each wheel made, (batch, wheels) m.

        Args:
            state: of the period before.
            voltage: (batch, wheels) V.
            period: s.
        """


@dataclass(frozen=True)
class LinearDrive:
    """The identified drive: V = kS·sign(v) + kV·v + kA·dv/dt.

    Attributes:
        drive: identified.
    """

    drive: Drive

    def begin(self, velocity: Tensor) -> State:
        """Return the velocity: nothing else changes."""
        return {VELOCITY: velocity}

    def advance(self, state: State, voltage: Tensor, period: float) -> tuple[State, Tensor]:
        """Return what the law makes of it, without error."""
        velocity, made = self.drive.advance(state[VELOCITY], voltage, period)
        return {VELOCITY: velocity}, made


class SimulatedDrive:
    """A simulated swerve drive whose modules are held straight, and which neither turns nor moves aside.

    Attributes:
        simulator: of a swerve drive.
        drive: identified, whose law says which voltage keeps a velocity.
    """

    def __init__(self, simulator: Simulator, drive: Drive) -> None:
        """Take a simulator.

        Raises:
            InputError: when it is not of a swerve drive.
        """
        if not isinstance(simulator.platform, Swerve):
            found = f"is a simulator of a {simulator.platform.kind}"
            raise InputError(found, "profile.simulators", "choose one of a swerve drive")
        idle = without_driver(simulator)
        self.simulator = simulator.with_effects(tuple(f for f in simulator.effects if f not in idle))
        self.drive = drive
        self._shape: Any = None

    def begin(self, velocity: Tensor) -> State:
        """Return drives at their mean velocity, remembering that they have kept it."""
        motion = velocity.new_zeros(len(velocity), _STATE_SIZE)
        motion[:, _FORWARD] = velocity.mean(-1)
        holding = self.drive.static * velocity.sign() + self.drive.speed * velocity
        # An effect or a model makes its memory in its first step.
        period = self.simulator.learned.time_step if self.simulator.learned else _LONGEST_STEP
        _, memory = self._step(motion, holding, (), period)
        return self._state(motion, memory)

    def advance(self, state: State, voltage: Tensor, period: float) -> tuple[State, Tensor]:
        """Return what the simulator makes of it; all wheels go as far as the chassis."""
        leaves = [state[f"{_MEMORY}{index}"] for index in range(self._shape.num_leaves)]
        memory = tree.tree_unflatten(leaves, self._shape)
        motion, memory = self._step(state[_MOTION], voltage, memory, period)
        straight = torch.zeros_like(motion)
        straight[:, _FORWARD] = motion[:, _FORWARD]
        after = self._state(straight, memory)
        return after, 0.5 * period * (state[VELOCITY] + after[VELOCITY])

    def _step(
        self, motion: Tensor, voltage: Tensor, memory: tuple[Any, ...], period: float
    ) -> tuple[Tensor, tuple[Any, ...]]:
        command = {"drive_voltage": voltage, "steer_voltage": torch.zeros_like(voltage)}
        substeps = max(math.ceil(period / _LONGEST_STEP - 1e-9), 1)
        with torch.no_grad():
            return step(self.simulator, motion, command, period, memory, substeps)

    def _state(self, motion: Tensor, memory: tuple[Any, ...]) -> State:
        leaves, self._shape = tree.tree_flatten(memory)
        remembered = {f"{_MEMORY}{index}": leaf.contiguous() for index, leaf in enumerate(leaves)}
        velocity = motion[:, _FORWARD, None].expand(-1, len(self.drive.speed))
        return {VELOCITY: velocity.contiguous(), _MOTION: motion, **remembered}
