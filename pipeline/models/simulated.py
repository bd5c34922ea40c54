"""A learned model as the dynamics of a simulator, or as the residual that its physics leave."""

from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import torch
from torch import Tensor

from simgap.errors import InputError
from simgap.models.contract import DynamicsModel
from simgap.models.examples import Physics
from simgap.models.layout import Layout
from simgap.models.machine_state import input_signals, machine_state
from simgap.models.storage import load_model, save_model
from simgap.physics.shapes import Signals
from simgap.platforms import Platform
from simgap.simulation import Simulator, read_simulator, step
from simgap.simulation.learned import DYNAMICS, PHYSICS_SUBSTEPS, RESIDUAL, Learned
from simgap.simulation.motion import motion_of


class Known(NamedTuple):
    """Memory before the first step.

    Attributes:
        kept: signals that the machine's motion does not hold.
        earlier: features of the samples before the present one, (batch, length − 1, features).
    """

    kept: dict[str, Tensor]
    earlier: Tensor


class Remembered(NamedTuple):
    """Memory after a step: `kept` as in `Known`, and what the model remembers of all samples so far."""

    kept: dict[str, Tensor]
    model: Any


class LearnedMotion(Learned):
    """A trained model that moves the machine of a platform.

    It predicts as `DynamicsModel.unroll` does: the present sample is the last of its window, its input is held over
    the step, and what comes out is seen next.
    """

    def __init__(self, model: DynamicsModel, platform: Platform, role: str = DYNAMICS) -> None:
        """Take a model into service.

        Raises:
            InputError: when it cannot move the platform's simulator, or was trained for the other role.
        """
        self.machine = machine_state(model.layout, platform, role)
        if model.residual != (role == RESIDUAL):
            learned, key = ("a residual", RESIDUAL) if model.residual else ("the whole motion", DYNAMICS)
            raise InputError(f"the model has learned {learned}", f"simulator.{role}", f"use simulator.{key}")
        self.model, self.role, self.time_step = model, role, model.time_step
        self.inputs = input_signals(model.layout)
        self._motion = motion_of(platform)

    def begin(self, signals: Signals) -> Known:
        """Return the window before the last sample; where it is longer than what is known, the first sample stays."""
        length = self.model.settings.sequence_length
        own = self.machine.seen(self._motion.pack(signals), signals)
        features = self.model.layout.encode(own, self._inputs(signals))
        chosen = torch.arange(-length, -1).clamp(min=-features.shape[1]) + features.shape[1]
        return Known({name: signals[name][:, -1] for name in self.machine.kept}, features[:, chosen])

    def follow(
        self, state: Tensor, signals: Signals, memory: Any, physics: Tensor | None = None
    ) -> tuple[Tensor, Remembered]:
        """Let the model see the state and predict the next one; see `Learned.follow`."""
        model, machine = self.model, self.machine
        kept = self._motion.signals(state) if memory is None else memory.kept
        own = machine.seen(state, kept)
        newest = model.layout.encode(own, self._inputs(signals))
        with torch.no_grad():
            remembered = self._with(newest, memory)
            following = None if physics is None else machine.seen(physics, self._motion.signals(physics))
            after = model.following(own, remembered, following)
        reached = machine.reached(after, state, self.time_step)
        if physics is not None:  # what the layout does not see moves as the physics move it
            assert following is not None
            reached = physics + (reached - machine.reached(following, state, self.time_step))
        return self._motion.normalise(reached), Remembered(machine.kept_of(after), remembered)

    def _with(self, newest: Tensor, memory: Any) -> Any:
        """Return what the model remembers once it has seen the features (batch, features) of the present sample."""
        if isinstance(memory, Remembered):
            return self.model.follow(memory.model, newest)
        length = self.model.settings.sequence_length
        earlier = newest[:, None].expand(-1, length - 1, -1) if memory is None else memory.earlier
        return self.model.begin(torch.cat([earlier, newest[:, None]], dim=1))

    def _inputs(self, signals: Signals) -> Tensor:
        """Return the inputs side by side, (..., inputs); a joint's signals have no components."""
        single = len(self.model.layout.inputs) == 1
        return torch.cat([signals[name][..., None] if single else signals[name] for name in self.inputs], -1)

    def describe(self) -> dict[str, Any]:
        """Return the names of model and layout, and its time step, s."""
        model = self.model
        return {"model": model.settings.name, "layout": model.layout.kind, "time_step": self.time_step}

    def save(self, folder: Path) -> None:
        """Write the model as `train` does."""
        save_model(self.model, folder)


def load_learned(folder: Path, platform: Platform, role: str) -> LearnedMotion:
    """Return the model in a folder as a part of a platform's simulator.

    Raises:
        InputError: when it cannot be read, or cannot be that part.
    """
    return LearnedMotion(load_model(folder), platform, role)


def read_learned_simulator(folder: Path) -> Simulator:
    """Read a simulator with its learned part, which `read_simulator` leaves out.

    Raises:
        InputError: when there is none, or it is damaged.
    """
    return read_simulator(folder, load_learned)


def physics_of(simulator: Simulator, layout: Layout, time_step: float) -> Physics:
    """Return the physics of a simulator as a function of a layout's states and inputs, for a residual to be learned.

    Raises:
        InputError: when the simulator has no such states, or remembers more than its state.
    """
    physics, machine = replace(simulator, learned=None), machine_state(layout, simulator.platform, RESIDUAL)
    motion, names = motion_of(simulator.platform), input_signals(layout)
    size = max(part.stop for part in motion.parts.values())
    for fitted in simulator.effects:
        if getattr(fitted.effect, "remembers", False):
            found = f"{fitted.effect.name} remembers, and a residual is learned sample by sample"
            raise InputError(found, "simulator.effects", "leave it out, or use simulator.dynamics")

    def following(states: Tensor, actions: Tensor) -> Tensor:
        width = actions.shape[-1] // len(names)
        parts = actions.split(width, dim=-1)
        command = {
            name: part[..., 0] if width == 1 else part for name, part in zip(names, parts, strict=True)
        }
        resting = states.new_zeros(*states.shape[:-1], size)
        state = machine.reached(states, resting, 0.0)
        after, _ = step(physics, state, command, time_step, substeps=PHYSICS_SUBSTEPS)
        return machine.seen(after, motion.signals(after))

    return following
