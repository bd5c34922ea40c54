"""A delayed second-order system with inputs held from sample to sample, solved exactly."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm


@dataclass(frozen=True)
class SecondOrder:
    """K·exp(−delay·s) / (1 + 2Tζs + T²s²).

    Attributes:
        gain: K.
        time_constant: T, s.
        damping: ζ.
        delay: s.
    """

    gain: float
    time_constant: float
    damping: float
    delay: float = 0.0


def responses(system: SecondOrder, time_step: float, steps: int) -> tuple[np.ndarray, np.ndarray]:
    """Return how the outputs at samples 0 to `steps` depend on initial state and inputs.

    Args:
        system: the transfer function.
        time_step: s.
        steps: number of held inputs; before the first of them the input was the same.

    Returns:
        Response to the initial output and its rate (steps + 1, 2), and to each input (steps + 1, steps).
    """
    whole, share = divmod(system.delay / time_step, 1.0)
    advance, late = _held(system, share * time_step)  # while the older input still acts
    rest, early = _held(system, (1.0 - share) * time_step)
    transition = rest @ advance
    free, forced = np.zeros((steps + 1, 2)), np.zeros((steps + 1, steps))
    state, driven = np.eye(2), np.zeros((2, steps))
    for step in range(steps + 1):
        free[step], forced[step] = state[0], driven[0]
        state, driven = transition @ state, transition @ driven
        for push, back in ((early, int(whole)), (rest @ late, int(whole) + 1)):
            if step < steps:
                driven[:, max(step - back, 0)] += push
    return free, forced


def _held(system: SecondOrder, duration: float) -> tuple[np.ndarray, np.ndarray]:
    """Return transition (2, 2) and effect (2,) of a unit input held for a duration, s."""
    square = system.time_constant**2
    rates = np.zeros((3, 3))
    rates[0, 1] = 1.0
    rates[1] = [-1.0 / square, -2.0 * system.damping / system.time_constant, system.gain / square]
    solved = expm(duration * rates)
    return solved[:2, :2], solved[:2, 2]
