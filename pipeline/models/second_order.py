"""A delayed second-order system with inputs held from sample to sample, solved exactly."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm, toeplitz


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
    free = np.zeros((steps + 1, 2))
    free[0, 0] = 1.0
    for step in range(steps):
        free[step + 1] = free[step] @ transition
    early_answer, late_answer = (np.append(0.0, free[:-1] @ push) for push in (early, rest @ late))
    back = int(whole)
    forced = toeplitz(_after(early_answer, back) + _after(late_answer, back + 1), np.zeros(steps))
    before = [_after(early_answer, step) for step in range(back)]
    forced[:, 0] += sum([*before, *(_after(late_answer, step) for step in range(back + 1))])
    return free, forced


def _after(answer: np.ndarray, steps: int) -> np.ndarray:
    """Return the answer (samples,) to a push that comes so many steps later."""
    return np.concatenate([np.zeros(steps), answer])[: len(answer)]


def _held(system: SecondOrder, duration: float) -> tuple[np.ndarray, np.ndarray]:
    """Return transition (2, 2) and effect (2,) of a unit input held for a duration, s."""
    square = system.time_constant**2
    rates = np.zeros((3, 3))
    rates[0, 1] = 1.0
    rates[1] = [-1.0 / square, -2.0 * system.damping / system.time_constant, system.gain / square]
    solved = expm(duration * rates)
    return solved[:2, :2], solved[:2, 2]
