"""Running a simulator forward in time."""

from collections.abc import Mapping
from typing import Any

import torch
from torch import Tensor

from pipeline.effects import ActuatorEffect, CommandEffect
from pipeline.physics.integrators import rk4
from pipeline.simulation.motion import motion_of
from pipeline.simulation.simulator import Simulator

Signals = Mapping[str, Tensor]


def step(
    simulator: Simulator,
    state: Tensor,
    command: Signals,
    time_step: float,
    memory: tuple[Any, ...] = (),
    substeps: int = 1,
) -> tuple[Tensor, tuple[Any, ...]]:
    """Advance a batch of simulated machines by one step with the command held.

    Args:
        simulator: platform and effects.
        state: (..., n), see `pipeline.simulation.motion`.
        command: `rotor_speed`, `motor_command`, `voltage`, `effort` or the swerve's voltages, each (..., ·).
        time_step: s.
        memory: of the effects that remember, from the previous step; empty before the first.
        substeps: integration steps inside the time step.

    Returns:
        The new state and the memory for the next step.
    """
    motion, constants = motion_of(simulator.platform), simulator.constants()
    command, memory = _remember(simulator, motion.signals(state), command, constants, memory, time_step)

    def derivative(now: Tensor) -> Tensor:
        signals = simulator.mechanism.actuate({**motion.signals(now), **command}, constants)
        for fitted in _memoryless(simulator):
            changed, _ = fitted.effect.actuate(signals, fitted.values, constants, None, time_step)
            signals = {**signals, **changed}
        return motion.derivative(now, simulator.balance(signals).wrench, constants)

    for _ in range(substeps):
        state = rk4(derivative, state, time_step / substeps)
    return motion.normalise(state), memory


def _remember(
    simulator: Simulator,
    signals: Signals,
    command: Signals,
    constants: dict[str, Any],
    memory: tuple[Any, ...],
    time_step: float,
) -> tuple[dict[str, Tensor], tuple[Any, ...]]:
    """Run the effects with memory once per step; between the samples of a log nothing else is known."""
    effects = [f for f in simulator.of_type(ActuatorEffect) if f.effect.remembers]  # type: ignore[attr-defined]
    memories = memory or (None,) * len(effects)
    out, after = dict(command), []
    for fitted, past in zip(effects, memories, strict=True):
        if not isinstance(fitted.effect, CommandEffect):
            out = {**out, **_actuated(simulator, {**signals, **out}, constants)}
        changed, kept = fitted.effect.actuate(  # type: ignore[attr-defined]
            {**signals, **out}, fitted.values, constants, past, time_step
        )
        out |= changed
        after.append(kept)
    return out, tuple(after)


def _actuated(simulator: Simulator, signals: Signals, constants: dict[str, Any]) -> dict[str, Tensor]:
    actuated = simulator.mechanism.actuate(signals, constants)
    return {name: value for name, value in actuated.items() if name not in signals}


def _memoryless(simulator: Simulator) -> list:
    return [f for f in simulator.of_type(ActuatorEffect) if not f.effect.remembers]  # type: ignore[attr-defined]


def rollout(
    simulator: Simulator, initial: Tensor, commands: Signals, time_step: float, substeps: int = 1
) -> Tensor:
    """Run a batch open loop.

    Args:
        simulator: platform and effects.
        initial: states at the first sample, (batch, n).
        commands: (batch, steps, ·) each, held over each step.
        time_step: s.
        substeps: integration steps inside each time step.

    Returns:
        States (batch, steps + 1, n), the initial one included.
    """
    states, memory = [initial], ()
    for index in range(next(iter(commands.values())).shape[1]):
        command = {name: series[:, index] for name, series in commands.items()}
        state, memory = step(simulator, states[-1], command, time_step, memory, substeps)
        states.append(state)
    return torch.stack(states, dim=1)
