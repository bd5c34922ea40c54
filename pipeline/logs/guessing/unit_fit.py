"""The units of a position and its velocity: from their names, and from one being the derivative of the other."""

from dataclasses import dataclass

from simgap.logs.guessing.motion import Slope
from simgap.recordings.units import conversion

_ANGLES = ("rad", "deg", "rev")
_RATES = ("rad/s", "deg/s", "rev/s", "rpm")
_LENGTHS = ("m", "mm", "cm")
_SPEEDS = ("m/s", "mm/s", "cm/s")
_TOLERANCE = 0.02  # of a ratio of units; 6 (deg and rpm) and 2π (rad and rev/s) are 5 % apart
_ROUGH = 0.15  # of a ratio of units where a filter or lost samples damp one of the two
_CLEAR = 0.97  # correlation from which on one is the derivative of the other
_SWINGS = 1.0, 12.6
"""Range in rad, one to two turns' worth, in which names in the notation of robotics mean rad: below they may be turns,
and above degrees; an arm seldom turns once."""
SEEN = 0.8  # correlation from which on they belong together


@dataclass(frozen=True)
class Fitted:
    """Units of position and velocity.

    Attributes:
        position: unit.
        velocity: unit.
        sign: −1 where they run against each other.
        sure: how sure, from 0 to 1.
        reason: in a few words.
    """

    position: str
    velocity: str
    sign: int
    sure: float
    reason: str


def unit_alone(unit: str | None, expected: str) -> tuple[str, float, str]:
    """Return the unit of a position or velocity beside which there is no other, how sure it is, and why."""
    if unit is not None:
        return unit, 0.93, f"by its name, in {unit}"
    return expected, 0.6, f"by its name; {expected} is taken, no unit is said"


def fit_units(
    position: str | None, velocity: str | None, slope: Slope | None, is_si: bool, swing: float
) -> Fitted:
    """Return the units of position and velocity.

    Args:
        position: declared unit; None where none is known.
        velocity: declared unit; None where none is known.
        slope: how the change of the position follows the integral of the velocity.
        is_si: whether the names are those of robotics libraries, which use rad.
        swing: range of the position in its own unit.
    """
    pairs = _pairs(position, velocity)
    sign = -1 if slope is not None and slope.correlation < -SEEN else 1
    clear = slope is not None and abs(slope.correlation) > _CLEAR
    if slope is None or not clear:
        sure, reason = _without(position, velocity, slope)
        return Fitted(*pairs[0], sign, sure * (0.6 if sign < 0 else 1.0), reason)
    fitting = [pair for pair in pairs if abs(_ratio(*pair) / abs(slope.factor) - 1.0) < _TOLERANCE]
    against = ", but with the other sign" if sign < 0 else ""
    if not fitting:
        reason = (
            f"its change is {abs(slope.factor):.4g} times the integral of the velocity{against}: "
            "no units explain that; correct the scale of one of them"
        )
        nearest = min(pairs, key=lambda pair: abs(_ratio(*pair) / abs(slope.factor) - 1.0))
        near = abs(_ratio(*nearest) / abs(slope.factor) - 1.0) < _ROUGH
        return Fitted(*nearest, sign, 0.75, reason) if near else Fitted(*pairs[0], sign, 0.4, reason)
    told = f"the velocity is its derivative in {fitting[0][0]} and {fitting[0][1]}{against}"
    penalty = 0.7 if sign < 0 else 1.0
    if position and velocity:
        return Fitted(*fitting[0], sign, 0.98 * penalty, told)
    if len(fitting) == 1:
        return Fitted(*fitting[0], sign, 0.95 * penalty, told)
    if is_si and ("rad", "rad/s") in fitting and _SWINGS[0] < swing < _SWINGS[1]:
        return Fitted("rad", "rad/s", sign, 0.92 * penalty, told)
    chosen = ("deg", "deg/s") if swing > _SWINGS[1] and ("deg", "deg/s") in fitting else fitting[0]
    told = f"the velocity is its derivative in {chosen[0]} and {chosen[1]}{against}"
    return Fitted(*chosen, sign, 0.65 * penalty, f"{told}, or in another unit of both: none is said")


def _pairs(position: str | None, velocity: str | None) -> list[tuple[str, str]]:
    angles = [(p, v) for p in _ANGLES for v in _RATES]
    lengths = [(p, v) for p in _LENGTHS for v in _SPEEDS]
    kept = [
        (p, v)
        for p, v in (*angles, *lengths)
        if (position is None or _same(p, position)) and (velocity is None or _same(v, velocity))
    ]
    if position is None and velocity is None:
        kept = [*angles, ("m", "m/s")]
    return [(position or p, velocity or v) for p, v in kept] or [(position or "rad", velocity or "rad/s")]


def _same(unit: str, declared: str) -> bool:
    return conversion(unit) == conversion(declared)


def _ratio(position: str, velocity: str) -> float:
    first, second = conversion(position), conversion(velocity)
    return second[1] / first[1] if first and second else float("nan")


def _without(position: str | None, velocity: str | None, slope: Slope | None) -> tuple[float, str]:
    """Return how sure the units are where no derivative shows them."""
    if slope is not None and abs(slope.correlation) < SEEN:
        return 0.5, f"the velocity is not its derivative (correlation {slope.correlation:.2f})"
    if position and velocity:
        return 0.93, "by its name and unit"
    return 0.6, "by its name; no unit is said"
