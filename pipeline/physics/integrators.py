"""One step of an ordinary differential equation (Hairer, Nørsett & Wanner 1993, "Solving ODEs I").

A state is a tensor (..., components); `derivative` maps it to its rate of change, of the same shape.
"""

from collections.abc import Callable

from jaxtyping import Float
from torch import Tensor

from simgap.physics.shapes import Signal

Same = Float[Tensor, "*state"]
Derivative = Callable[[Same], Same]
Step = float | Signal  # s


def euler(derivative: Derivative, state: Same, dt: Step) -> Same:
    """Return the state dt later by the explicit Euler rule, of first order."""
    return state + dt * derivative(state)


def rk4(derivative: Derivative, state: Same, dt: Step) -> Same:
    """Return the state dt later by the classical Runge–Kutta rule, of fourth order."""
    first = derivative(state)
    second = derivative(state + 0.5 * dt * first)
    third = derivative(state + 0.5 * dt * second)
    fourth = derivative(state + dt * third)
    return state + (dt / 6.0) * (first + 2.0 * (second + third) + fourth)


def semi_implicit(
    acceleration: Callable[[Same, Same], Same], position: Same, velocity: Same, dt: Step
) -> tuple[Same, Same]:
    """Return (position, velocity) dt later by the symplectic Euler rule, of first order.

    The new velocity moves the position, which keeps the energy of an oscillation bounded.

    Args:
        acceleration: maps (position, velocity) to acceleration.
        position: (..., components).
        velocity: rate of change of the position, same shape.
        dt: s.
    """
    velocity = velocity + dt * acceleration(position, velocity)
    return position + dt * velocity, velocity
