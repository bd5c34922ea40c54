"""A simulator for a person's own program: one shape rule for every kind of machine, NumPy arrays or tensors."""

from collections.abc import Mapping
from typing import Any, overload

import numpy as np
import torch
from numpy.typing import ArrayLike, NDArray
from torch import Tensor

from simgap.api.arrays import (
    alike,
    like,
    require_one_batch,
    require_shape,
    require_time_step,
    spread,
    to_tensor,
)
from simgap.api.layout import layout_of
from simgap.api.memory import Memory
from simgap.errors import InputError
from simgap.platforms import Platform
from simgap.simulation import FittedEffect, Simulator, step
from simgap.simulation.driver import SimulatedDriver

_EXOGENOUS = ("battery_voltage", "temperature")  # scalar inputs beside the command, V and °C
_INPUTS = (*_EXOGENOUS, "voltage", "position_command")  # what an effect may need and a state does not hold


class Machine:
    """A simulated quadrotor, swerve drive or joint: its platform and the effects that it is believed to have.

    Shapes: a state is (..., n) with the entries `state_names`, a command is (..., m) with the entries `command_names`.
    Leading dimensions are batches and broadcast. SI units; world frame x forward, y left, z up; body frame the same;
    quaternions scalar-first, body to world. A quadrotor's velocity is in the world frame and its body rate in the body
    frame; a swerve drive's velocity is in the robot frame and its heading is counted from the start.

    NumPy arrays give NumPy arrays, tensors give tensors with their gradients and on their device. float32 stays
    float32, whole numbers become float64. The state is the true one: offsets of sensors are not part of it.

    Attributes:
        simulator: of `simgap.simulation`, which does the work.
        state_names: the n entries of a state, as the columns of a recording are called.
        command_names: the m entries of a command.
        units: the unit of each of these entries.
    """

    def __init__(self, simulator: Simulator, command: str | None = None) -> None:
        """Wrap a simulator.

        Args:
            simulator: platform and effects.
            command: what drives it: `motor_command` (the default) or `motor_speed` of a quadrotor, `voltage` (the
                default where the platform has a motor), `position_command` (the default where it has a controller and
                no motor) or `effort` of a joint, `voltages` of a swerve drive.

        Raises:
            InputError: when the platform cannot be driven so.
        """
        self._layout = layout_of(simulator.platform, command, simulator.position_unit)
        self.simulator = simulator
        self.state_names = self._layout.state
        self.command_names = self._layout.command
        self.units: Mapping[str, str] = self._layout.units

    @property
    def kind(self) -> str:
        """`quadrotor`, `swerve` or `joint`."""
        return self.simulator.platform.kind

    @property
    def platform(self) -> Platform:
        """What is known of the machine: a `Quadrotor`, `Swerve` or `Joint`."""
        return self.simulator.platform

    @property
    def effects(self) -> tuple[FittedEffect, ...]:
        """The effects beyond the nominal equations, with their values and standard errors."""
        return self.simulator.effects

    def __repr__(self) -> str:
        named = ", ".join(fitted.effect.key for fitted in self.effects) or "none"
        return f"Machine({self.kind}, command: {', '.join(self.command_names)}, effects: {named})"

    def state(self, **entries: float) -> NDArray[np.float64]:
        """Return a state (n,) at rest, level and at the origin, but for the entries that are given by name.

        Raises:
            InputError: when the state has no such entry.
        """
        values = {name: float(name == "attitude_w") for name in self.state_names}
        for name, value in entries.items():
            if name not in values:
                remedy = f"use {', '.join(self.state_names)}"
                raise InputError(f"the state of a {self.kind} has no {name!r}", remedy=remedy)
            values[name] = float(value)
        return np.array(list(values.values()))

    @overload
    def step(
        self,
        state: Tensor,
        command: Tensor,
        dt: float,
        memory: Memory | None = None,
        *,
        substeps: int = 1,
        exogenous: Mapping[str, Any] | None = None,
    ) -> Tensor: ...
    @overload
    def step(
        self,
        state: ArrayLike,
        command: ArrayLike,
        dt: float,
        memory: Memory | None = None,
        *,
        substeps: int = 1,
        exogenous: Mapping[str, Any] | None = None,
    ) -> NDArray[Any]: ...
    def step(
        self,
        state: Any,
        command: Any,
        dt: float,
        memory: Memory | None = None,
        *,
        substeps: int = 1,
        exogenous: Mapping[str, Any] | None = None,
    ) -> Any:
        """Return the state one time step later.

        Args:
            state: (..., n).
            command: (..., m), held through the step.
            dt: time step, s.
            memory: of the effects with a hidden state; the call updates it. Give the same one to each call of a
                simulation. Without it those effects start at rest in each call.
            substeps: integration steps (fourth-order Runge–Kutta) within the time step. Friction that holds, play
                and short lags need several.
            exogenous: further inputs, each (...,): `battery_voltage` V, `temperature` °C. What a diagnosis learned of
                them is used where they are not given.

        Raises:
            InputError: on a wrong shape, time step or memory, or where an effect lacks an input.
        """
        commands = to_tensor(command, "command")
        require_shape(commands, "command", [len(self.command_names)])
        later = {name: to_tensor(value, name)[..., None] for name, value in (exogenous or {}).items()}
        states = self.rollout(
            to_tensor(state, "state"), commands[..., None, :], dt, memory, substeps=substeps, exogenous=later
        )
        return like(states[..., -1, :], state, command)

    @overload
    def rollout(
        self,
        state: Tensor,
        commands: Tensor,
        dt: float,
        memory: Memory | None = None,
        *,
        substeps: int = 1,
        exogenous: Mapping[str, Any] | None = None,
    ) -> Tensor: ...
    @overload
    def rollout(
        self,
        state: ArrayLike,
        commands: ArrayLike,
        dt: float,
        memory: Memory | None = None,
        *,
        substeps: int = 1,
        exogenous: Mapping[str, Any] | None = None,
    ) -> NDArray[Any]: ...
    def rollout(
        self,
        state: Any,
        commands: Any,
        dt: float,
        memory: Memory | None = None,
        *,
        substeps: int = 1,
        exogenous: Mapping[str, Any] | None = None,
    ) -> Any:
        """Return the states through a series of commands, the initial one included: (..., steps + 1, n).

        It is what repeated calls of `step` with one memory give.

        Args:
            state: at the first command, (..., n).
            commands: (..., steps, m), each held through its time step.
            dt: time step, s.
            memory: as for `step`.
            substeps: as for `step`.
            exogenous: as for `step`, each (..., steps) or one number.

        Raises:
            InputError: on a wrong shape, time step or memory, or where an effect lacks an input.
        """
        dt = require_time_step(dt)
        if substeps < 1:
            raise InputError(f"substeps must be at least 1; got {substeps}")
        batch, start, signals = self._given(state, commands, exogenous or {})
        kept = (memory or Memory()).of(batch, dt / substeps)
        states, remembered = [start], kept.effects
        for index in range(signals[next(iter(signals))].shape[1]):
            now = {name: series[:, index] for name, series in signals.items()}
            after, remembered = step(self.simulator, states[-1], now, dt, remembered, substeps)
            states.append(after)
        kept.effects = remembered
        whole = torch.stack(states, dim=1)
        return like(whole.reshape(*batch, *whole.shape[1:]), state, commands)

    def _given(
        self, state: Any, commands: Any, exogenous: Mapping[str, Any]
    ) -> tuple[torch.Size, Tensor, dict[str, Tensor]]:
        """Return the batch, its states (machines, n) and signals of the simulation (machines, steps, ...)."""
        self._require_inputs(set(exogenous))
        given = {"state": state, "commands": commands, **exogenous}
        start, inputs, *others = alike(*(to_tensor(value, name) for name, value in given.items()))
        require_shape(start, "state", [len(self.state_names)])
        require_shape(inputs, "commands", ["steps", len(self.command_names)])
        steps = inputs.shape[-2]
        series = {
            name: entry if entry.ndim else entry.expand(steps)
            for name, entry in zip(exogenous, others, strict=True)
        }
        for name, entry in series.items():
            require_shape(entry, name, [steps])
        leading = {"state": start.shape[:-1], "commands": inputs.shape[:-2]}
        batch = require_one_batch(leading | {name: entry.shape[:-1] for name, entry in series.items()})
        signals = self._layout.parted(spread(inputs, batch, 2))
        signals |= {name: spread(entry, batch, 1) for name, entry in series.items()}
        return batch, spread(start, batch, 1), signals

    def _require_inputs(self, exogenous: set[str]) -> None:
        """Refuse inputs that no machine has, and effects that lack an input of theirs."""
        for name in exogenous - set(_EXOGENOUS):
            raise InputError(f"there is no exogenous input {name!r}", remedy=f"use {' or '.join(_EXOGENOUS)}")
        laws = [f.effect for f in self.effects if isinstance(f.effect, SimulatedDriver)]
        known = {*exogenous, *self._layout.signals, *(law.driven.driver for law in laws)}
        for effect in (fitted.effect for fitted in self.effects):
            for need in (need for need in effect.needs if need in _INPUTS and need not in known):
                how = f"exogenous={{{need!r}: ...}}" if need in _EXOGENOUS else f"command={need!r}"
                raise InputError(f"{effect.key} needs {need}", remedy=f"give {how}")
