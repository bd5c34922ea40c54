"""Open-loop simulation of a batch of machines."""

from functools import partial
from typing import Any

import torch
from jaxtyping import Float
from torch import Tensor

from simgap.physics.shapes import Signal, Signals, State
from simgap.simulation.actuation import Memory, actuated, held_through
from simgap.simulation.integration import INTEGRATORS
from simgap.simulation.learned import PHYSICS_SUBSTEPS, RESIDUAL, Learned
from simgap.simulation.motion import Motion, motion_of_state
from simgap.simulation.simulator import Simulator


def step(
    simulator: Simulator,
    state: State,
    command: Signals,
    time_step: float,
    memory: Memory = (),
    substeps: int = 1,
    integrator: str = "rk4",
) -> tuple[State, Memory]:
    """Advance a batch of simulated machines by one step with the command held.

    A simulator with a learned part takes the model's own steps, of which the time step has to be a multiple.

    Args:
        simulator: platform and effects.
        state: (..., n), see `simgap.simulation.motion`; (batch, n) where a part is learned.
        command: `rotor_speed`, `motor_command`, `voltage`, `effort` or the swerve's voltages, each (..., ·), and what
            else acts from outside (`battery_voltage`, `temperature`).
        time_step: s.
        memory: of the effects that remember, from the previous step; empty before the first.
        substeps: integration steps inside the time step.
        integrator: `euler`, `semi_implicit` or `rk4`.

    Returns:
        The new state and the memory for the next step.

    Raises:
        InputError: when the time step is no multiple of a learned model's.
    """
    if simulator.learned is not None:
        return _learned_step(simulator, simulator.learned, state, command, time_step, memory, integrator)
    return _physics_step(simulator, state, command, time_step, memory, substeps, integrator)


def _learned_step(
    simulator: Simulator,
    learned: Learned,
    state: Tensor,
    command: Signals,
    time_step: float,
    memory: Memory,
    integrator: str,
) -> tuple[Tensor, Memory]:
    """Let the model move the machines; its memory is the last, behind those of the effects."""
    inner = learned.time_step
    effects, remembered = (memory[:-1], memory[-1]) if memory else ((), None)
    for _ in range(learned.steps_in(time_step)):
        signals, acted = _driving(simulator, learned, state, command, effects)
        physics = None
        if learned.role == RESIDUAL:
            physics, acted = _physics_step(
                simulator, state, command, inner, effects, PHYSICS_SUBSTEPS, integrator
            )
        state, remembered = learned.follow(state, signals, remembered, physics)
        effects = acted
    return state, (*effects, remembered)


def _driving(
    simulator: Simulator, learned: Learned, state: Tensor, command: Signals, memory: Memory
) -> tuple[Signals, Memory]:
    """Return what drives a learned model: the command, or what the actuators make of it where the model wants that."""
    if command.keys() >= set(learned.inputs):
        return command, memory
    motion, constants = motion_of_state(simulator.platform, state), constants_like(simulator, state)
    start = {**motion.signals(state, constants), **command}
    held, after = held_through(simulator, start, constants, memory, learned.time_step)
    return actuated(simulator, start, constants, held, learned.time_step), after


def _physics_step(
    simulator: Simulator,
    state: Tensor,
    command: Signals,
    time_step: float,
    memory: Memory,
    substeps: int,
    integrator: str,
) -> tuple[Tensor, Memory]:
    motion, constants = motion_of_state(simulator.platform, state), constants_like(simulator, state)
    inner = time_step / substeps
    for _ in range(substeps):
        state, memory = _integrate(simulator, motion, constants, state, command, memory, inner, integrator)
    return motion.normalise(state), memory


def constants_like(simulator: Simulator, state: Signal) -> dict[str, Any]:
    """Return the simulator's constants on the device and in the precision of a state."""
    constants = simulator.constants()
    return {n: value.to(state) if isinstance(value, Tensor) else value for n, value in constants.items()}


def _integrate(
    simulator: Simulator,
    motion: Motion,
    constants: dict[str, Any],
    state: Tensor,
    command: Signals,
    memory: Memory,
    time_step: float,
    integrator: str,
) -> tuple[Tensor, Memory]:
    start = {**motion.signals(state, constants), **command}
    held, memory = held_through(simulator, start, constants, memory, time_step)
    wrench = partial(_wrench, simulator, motion, constants, command, held, time_step)
    return INTEGRATORS[integrator](motion, wrench, state, constants, time_step), memory


def _wrench(
    simulator: Simulator,
    motion: Motion,
    constants: dict[str, Any],
    command: Signals,
    held: list[dict[str, Tensor]],
    time_step: float,
    state: Tensor,
) -> dict[str, Tensor]:
    """Return what acts at one instant of a step."""
    signals = {**motion.signals(state, constants), **command}
    return simulator.wrench(actuated(simulator, signals, constants, held, time_step), constants)


def rollout(
    simulator: Simulator,
    initial: Float[Tensor, "batch components"],
    commands: Signals,
    time_step: float,
    substeps: int = 1,
    integrator: str = "rk4",
    memory: Memory = (),
) -> Float[Tensor, "batch samples components"]:
    """Run a batch open loop.

    Args:
        simulator: platform and effects.
        initial: states at the first sample, (batch, n).
        commands: (batch, steps, ·) each, held over each step.
        time_step: s.
        substeps: integration steps inside each time step.
        integrator: `euler`, `semi_implicit` or `rk4`.
        memory: of the effects that remember, where they have a past.

    Returns:
        States (batch, steps + 1, n), the initial one included.
    """
    states = [initial]
    for index in range(next(iter(commands.values())).shape[1]):
        command = {name: series[:, index] for name, series in commands.items()}
        state, memory = step(simulator, states[-1], command, time_step, memory, substeps, integrator)
        states.append(state)
    return torch.stack(states, dim=1)
