"""Numbers, places and turning senses of the rotors of quadrotors, as flight controllers count them."""

from collections.abc import Sequence
from math import copysign, cos, radians, sin

Rotor = tuple[int, str]
"""Angle from the front, degrees clockwise seen from above; and which way it turns, seen from above: CW or CCW."""

X: tuple[Rotor, ...] = ((45, "CCW"), (-135, "CCW"), (-45, "CW"), (135, "CW"))
PLUS: tuple[Rotor, ...] = ((90, "CCW"), (-90, "CCW"), (0, "CW"), (180, "CW"))
BETAFLIGHT_X: tuple[Rotor, ...] = ((135, "CW"), (45, "CCW"), (-135, "CCW"), (-45, "CW"))


def reversed_(rotors: Sequence[Rotor]) -> tuple[Rotor, ...]:
    """Return the same rotors, each turning the other way."""
    return tuple((angle, "CW" if sense == "CCW" else "CCW") for angle, sense in rotors)


ARDUPILOT: dict[int, tuple[Rotor, ...]] = {
    0: PLUS,
    1: X,
    2: X,  # V: as X, with other gains of yaw
    3: reversed_(X),  # H
    6: reversed_(PLUS),
    12: BETAFLIGHT_X,
    13: ((45, "CCW"), (-45, "CW"), (-135, "CCW"), (135, "CW")),  # as DJI counts
    14: ((45, "CCW"), (135, "CW"), (-135, "CCW"), (-45, "CW")),  # clockwise
    18: reversed_(BETAFLIGHT_X),
}
"""FRAME_TYPE to rotors, of AP_MotorsMatrix::setup_quad_matrix; frames without four rotors in a plane are missing."""

_PLACES = {
    0: "front", 45: "front right", 90: "right", 135: "rear right",
    180: "rear", -135: "rear left", -90: "left", -45: "front left",
}  # fmt: skip


def order_note(rotors: Sequence[Rotor]) -> str:
    """Return what a platform file must have, so that its rotors are those of the recording."""
    named = [f"{_PLACES[int(angle)]} ({sense})" for angle, sense in rotors]
    return f"{_placed(named, rotors)} of x and y, and rotor_directions {directions(rotors)}."


def places_note(rotors: Sequence[Rotor]) -> str:
    """Return where the rotors are, in the order of the log, whichever way they turn."""
    return f"{_placed([_PLACES[int(angle)] for angle, _ in rotors], rotors)} of x and y."


def _placed(named: Sequence[str], rotors: Sequence[Rotor]) -> str:
    numbered = ", ".join(f"{number} {name}" for number, name in enumerate(named, 1))
    signs = ", ".join(f"[{_sign(cos(radians(a)))}, {_sign(-sin(radians(a)))}]" for a, _ in rotors)
    return f"Motors, seen from above: {numbered}. So the platform file needs rotor_positions with the signs [{signs}]"


def places_of(rotors: Sequence[Rotor]) -> tuple[tuple[int, int], ...]:
    """Return the signs of x (forward) and y (left) of each rotor."""
    signs = [(round(cos(radians(angle)), 9), round(-sin(radians(angle)), 9)) for angle, _ in rotors]
    return tuple(((x > 0) - (x < 0), (y > 0) - (y < 0)) for x, y in signs)


def mixer_of(rotors: Sequence[Rotor]) -> list[list[float]]:
    """Return the sign of each rotor's torque about x (left ones lift), y (rear ones lift) and z, 3×4."""
    left = [copysign(1.0, -sin(radians(angle))) for angle, _ in rotors]
    rear = [copysign(1.0, -cos(radians(angle))) for angle, _ in rotors]
    return [left, rear, [float(each) for each in directions(rotors)]]


def directions(rotors: Sequence[Rotor]) -> list[int]:
    """Return +1 where the reaction torque on the body is about +z (up): of rotors that turn clockwise."""
    return [1 if sense == "CW" else -1 for _, sense in rotors]


def geometry_note(positions: Sequence[Sequence[float]], senses: Sequence[int]) -> str:
    """Return what a platform file must have, where the log says the places of the rotors.

    Args:
        positions: 4×[x, y, z], m, body frame x forward, y left, z up.
        senses: 4×(+1 or −1), as `rotor_directions`.
    """
    shown = ", ".join("[" + ", ".join(f"{value:.4g}" for value in place) + "]" for place in positions)
    return (
        f"The platform file needs the rotors in the order of the log: rotor_positions [{shown}] m and "
        f"rotor_directions {list(senses)}."
    )


def _sign(value: float) -> str:
    return "0" if abs(value) < 1e-9 else "+" if value > 0 else "-"
