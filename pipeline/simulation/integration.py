"""Integrators of a machine's state, each tested for its order of convergence.

Source: Hairer, Nørsett & Wanner 1993, Solving ODEs I, chapter II; Hairer, Lubich & Wanner 2006, Geometric numerical
integration, section I.1.2 (the symplectic Euler rule).
"""

from collections.abc import Callable, Mapping
from typing import Any

import torch

from simgap.physics import integrators
from simgap.physics.shapes import Real, State
from simgap.simulation.motion import Motion

Wrench = Callable[[State], Mapping[str, Real]]
Rule = Callable[[Motion, Wrench, State, Mapping[str, Any], float], State]


def euler(
    motion: Motion, wrench: Wrench, state: State, constants: Mapping[str, Any], time_step: float
) -> State:
    """Return the state a step later by the explicit rule of first order."""
    return integrators.euler(lambda now: motion.derivative(now, wrench(now), constants), state, time_step)


def rk4(
    motion: Motion, wrench: Wrench, state: State, constants: Mapping[str, Any], time_step: float
) -> State:
    """Return the state a step later by the classical Runge–Kutta rule, of fourth order."""
    return integrators.rk4(lambda now: motion.derivative(now, wrench(now), constants), state, time_step)


def semi_implicit(
    motion: Motion, wrench: Wrench, state: State, constants: Mapping[str, Any], time_step: float
) -> State:
    """Return the state a step later by the symplectic Euler rule, of first order: new velocities move the positions."""
    acting = wrench(state)
    faster = state + time_step * motion.derivative(state, acting, constants)
    moving = torch.zeros(state.shape[-1], dtype=torch.bool, device=state.device)
    for name in motion.velocities:
        moving[motion.parts[name]] = True
    between = torch.where(moving, faster, state)
    return torch.where(moving, faster, state + time_step * motion.derivative(between, acting, constants))


INTEGRATORS: dict[str, Rule] = {"euler": euler, "semi_implicit": semi_implicit, "rk4": rk4}
