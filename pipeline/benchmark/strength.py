"""The size at which a concealed effect is clear, or faint, on its machine and motion."""

import math
from collections.abc import Callable

BOUNDS = {"clear": (10.0, math.inf), "faint": (0.5, 2.0)}
"""Energy that an effect adds to the residual, divided by the noise energy: low and high limit."""

MOST = 5.0
"""Greatest size of an effect, as a multiple of its usual size; more is unrealistic."""

_TRIES = 10
_GREATEST_FACTOR = 30.0  # by which a strength changes at most from one try to the next


def settle_strength(energy_of: Callable[[float], float], wanted: str) -> tuple[float, float]:
    """Return the size at which an effect is clear or faint, and its energy there.

    The energy grows with about the square of the strength, which gives the next try; between a try that was too faint
    and one that was too strong, it is their geometric mean. An effect that is clear at its usual strength keeps it.

    Args:
        energy_of: the energy of a strength over the noise's, 1 being usual; not above zero where nothing shows.
        wanted: `clear` or `faint`.

    Returns:
        The strength that comes nearest, and its energy, which may lie outside the bounds.
    """
    low, high = BOUNDS[wanted]
    target = math.sqrt(low * high) if math.isfinite(high) else 1.5 * low
    tried: dict[float, float] = {}
    strength = 1.0
    while strength not in tried and len(tried) < _TRIES:
        tried[strength] = energy = energy_of(strength)
        if is_settled(energy, wanted):
            return strength, energy
        strength = min(_next_strength(tried, low, target), MOST)
    return min(tried.items(), key=lambda pair: _distance(pair[1], low, high))


def is_settled(energy: float, wanted: str) -> bool:
    """Whether an effect of that energy over the noise's is what was wanted."""
    low, high = BOUNDS[wanted]
    return low <= energy <= high


def _next_strength(tried: dict[float, float], low: float, target: float) -> float:
    fainter = [strength for strength, energy in tried.items() if energy < low]
    stronger = [strength for strength, energy in tried.items() if energy >= low]
    if fainter and stronger:
        return math.sqrt(max(fainter) * min(stronger))
    strength, energy = list(tried.items())[-1]
    factor = math.sqrt(target / energy) if energy > 0 else _GREATEST_FACTOR
    return strength * min(max(factor, 1.0 / _GREATEST_FACTOR), _GREATEST_FACTOR)


def _distance(energy: float, low: float, high: float) -> float:
    """Return how far an energy is from the bounds, as a logarithm."""
    if energy <= 0:
        return math.inf
    return max(math.log(low) - math.log(energy), math.log(energy) - math.log(high), 0.0)
