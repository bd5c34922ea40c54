"""A quadrotor in a log of no known layout: by vectors in its names, and by what they are of each other."""

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from simgap.logs.guessing.attitude import Turn, is_quaternion, turn_of
from simgap.logs.guessing.inputs import supply_of
from simgap.logs.guessing.motion import Slope, is_still, slope_of
from simgap.logs.guessing.motors import motors_of
from simgap.logs.guessing.parts import named_signals
from simgap.logs.guessing.specific_force import specific_force
from simgap.logs.guessing.vectors import Vector, is_estimated, vectors_of
from simgap.logs.guessing.words import COMMANDED, Said
from simgap.logs.log import Log, Signal
from simgap.logs.mapping import Source
from simgap.logs.proposal import Proposal, Proposed, lacking
from simgap.recordings.units import conversion

_RATE_WORDS = frozenset((
    "w", "gyro", "gyr", "omega", "rate", "rates", "bodyrate", "angvel", "angular", "rotation", "p",
))  # fmt: skip
_POSITION_WORDS = frozenset(("p", "pos", "position", "loc", "location"))
_VELOCITY_WORDS = frozenset(("v", "vel", "velocity", "speed"))
_COMPARED = 8  # vectors of each sort, of which all pairs are compared
_CLEAR = 0.95  # correlation from which on one vector is the derivative of the other on every axis
_SEEN = 0.8  # correlation from which on they belong together, if samples were lost
_ROUGH = 0.3  # of a factor, where samples were lost; degrees are 57 times away
_NEAR = 0.05  # of a factor of units
_TAKEN = 0.8  # confidence of an attitude whose frame only the name of the position says
_DEGREE = np.pi / 180.0
_AXES = ("x", "y", "z")
_ADVICE = {
    "position": "log the position of the vehicle in the world, m",
    "attitude": "log the attitude: a quaternion, or the angles roll, pitch and yaw",
    "velocity": "log the velocity in the world frame, m/s",
    "body_rate": "log the gyroscope, rad/s",
    "motor": "log what each of the four motors is told, or its speed",
}


def propose_quadrotor(log: Log, said: dict[str, Said]) -> Proposal | None:
    """Propose the columns of a quadrotor; None where there is no quaternion that turns, or no four motors.

    Args:
        log: with times in s.
        said: what the names of its signals say, without those of the clock.
    """
    vectors = [each for each in vectors_of(said) if not (each.words & (COMMANDED | {"r"}))]
    triples = [each for each in vectors if each.axes == "xyz"]
    columns: dict[str, Proposed] = {}
    motors = motors_of(log, said)
    attitude = _attitude(log, vectors, triples)
    if attitude is not None:
        columns |= attitude
    pair = _position_and_velocity(log, triples)
    if not motors or (attitude is None and pair is None):
        return None
    columns |= (pair or {}) | motors
    measured = specific_force(log, triples, columns)
    frame = _UP
    if measured.down:
        columns, frame = _turned_over(columns), _DOWN
    elif any(
        vector.down and columns["position_x"].source.signal == vector.names[0] for vector in triples if pair
    ):
        columns, frame = _as_named(_turned_over(columns)), _DOWN
    columns |= measured.columns
    battery = supply_of(log, named_signals(said), ())
    if battery is not None:
        columns["battery_voltage"] = battery
    lost = lacking("quadrotor", set(columns))
    missing = {name: advice for name in lost if (advice := _advice(name))}
    return Proposal(
        "quadrotor", columns, missing, notes=(_ORDER, frame, *measured.notes), refusal=_refusal(log, columns)
    )


_ORDER = "The motors are taken in the order of the log: rotor_positions of the platform have to be in the same order."
_UP = (
    "World z is taken as up, body x as forward and y as left, where the accelerometer does not say otherwise."
)
_DOWN = "In the log z points down. Signs of y and z are changed: world z is up, body x forward and y left."


def _turned_over(columns: dict[str, Proposed]) -> dict[str, Proposed]:
    """Return columns of frames with z down in those of the contract: y and z change their signs."""
    turned = {}
    for name, found in columns.items():
        if name.startswith(("position", "velocity", "attitude", "body_rate")) and name[-1] in "yz":
            source = replace(found.source, sign=-found.source.sign)
            found = replace(found, source=source, reason=f"{found.reason}; z points down in the log")
        turned[name] = found
    return turned


def _as_named(columns: dict[str, Proposed]) -> dict[str, Proposed]:
    """Return columns of a flight that is named after north, east and down, with its attitude to be confirmed."""
    return {
        name: replace(
            found,
            confidence=min(found.confidence, _TAKEN),
            reason=f"{found.reason}, as in the position's name",
        )
        if name.startswith(("attitude", "body_rate"))
        else found
        for name, found in columns.items()
    }


def _advice(column: str) -> str:
    return next((advice for start, advice in _ADVICE.items() if column.startswith(start)), "")


def _signals(log: Log, vector: Vector) -> list[Signal]:
    return [log.signals[name] for name in vector.names]


def _plain(vector: Vector) -> tuple[bool, int]:
    return is_estimated(vector), len(vector.context)


def _attitude(log: Log, vectors: list[Vector], triples: list[Vector]) -> dict[str, Proposed] | None:
    """Propose the quaternion and the rates that fit it best, of those with the plainest names."""
    found: list[tuple[tuple[bool, int], Vector, Vector, Turn]] = []
    for quaternion in (each for each in vectors if len(each.axes) == 4):
        parts = _signals(log, quaternion)
        if not is_quaternion(parts):
            continue
        near = sorted((each for each in triples if each.words & _RATE_WORDS), key=_plain)[:_COMPARED]
        for rates in near:
            if rates.names == quaternion.names[1:]:
                continue
            turn = turn_of(parts, _signals(log, rates))
            if turn is not None and turn.correlation > _SEEN:
                found.append((max(_plain(quaternion), _plain(rates)), quaternion, rates, turn))
    if not found:
        return _attitude_alone(log, vectors, any(each.words & _RATE_WORDS for each in triples))
    _, quaternion, rates, turn = min(found, key=lambda each: (each[0], -each[3].correlation))
    names = quaternion.names if turn.scalar_first else np.roll(quaternion.names, 1).tolist()
    named, rates_clear = quaternion.axes == "wxyz", turn.correlation > _CLEAR
    why = "norm one, and it turns as the body rates say"
    why += "" if turn.is_rotation else ", but mirrored: has one of the angles another sign?"
    sure = 0.97 if turn.is_rotation and (named == turn.scalar_first or not named) else 0.5
    columns = {
        f"attitude_{axis}": Proposed(Source(name), sure, why)
        for axis, name in zip("wxyz", names, strict=True)
    }
    for axis, signal, factor in zip(_AXES, _signals(log, rates), turn.factors, strict=True):
        columns[f"body_rate_{axis}"] = _rate(signal, factor, rates_clear)
    return columns


def _attitude_alone(log: Log, vectors: list[Vector], rated: bool) -> dict[str, Proposed] | None:
    fitting = [each for each in vectors if len(each.axes) == 4 and is_quaternion(_signals(log, each))]
    if not fitting:
        return None
    vector = min(fitting, key=_plain)
    sure = 0.9 if vector.axes == "wxyz" and not rated else 0.5
    why = "norm one; no body rates " + ("turn it" if rated else "to compare it with")
    return {
        f"attitude_{axis}": Proposed(Source(name), sure, why)
        for axis, name in zip("wxyz", vector.names, strict=True)
    }


def _rate(signal: Signal, factor: float, clear: bool) -> Proposed:
    sign = -1 if factor < 0 else 1
    for unit, size in (("rad/s", 1.0), ("deg/s", _DEGREE)):
        if abs(abs(factor) / size - 1.0) < _ROUGH:
            declared = conversion(signal.unit) if signal.unit else None
            agrees = declared is None or declared == conversion(unit)
            near = clear and abs(abs(factor) / size - 1.0) < 2 * _NEAR
            sure = (0.95 if near else 0.8) if agrees else 0.5
            why = f"turns the quaternion, in {unit}" + (" with the other sign" if sign < 0 else "")
            return Proposed(Source(signal.name, unit, sign=sign), sure, why)
    return Proposed(
        Source(signal.name, "rad/s", sign=sign), 0.5, f"the quaternion turns {factor:.3g} times as fast"
    )


def _position_and_velocity(log: Log, triples: list[Vector]) -> dict[str, Proposed] | None:
    """Propose the two vectors of which one is the derivative of the other, the plainest names first."""
    found: list[tuple[tuple[bool, int], Vector, Vector, list[Slope]]] = []
    places = [each for each in triples if not each.letters or each.letters in _POSITION_WORDS]
    speeds = [each for each in triples if each.words & _VELOCITY_WORDS]
    for position, velocity in itertools.product(
        sorted(places, key=_plain)[:_COMPARED], sorted(speeds, key=_plain)[:_COMPARED]
    ):
        if velocity is not position:
            slopes = _slopes(_signals(log, position), _signals(log, velocity))
            if slopes and all(slope.correlation > _CLEAR for slope in slopes):
                found.append((max(_plain(position), _plain(velocity)), position, velocity, slopes))
    if not found:
        return None
    _, position, velocity, slopes = min(found, key=lambda each: each[0])
    columns = {}
    for axis, where, speed, slope in zip(_AXES, position.names, velocity.names, slopes, strict=True):
        factor = slope.factor * _size(log.signals[where]) / _size(log.signals[speed])
        error = abs(factor - 1.0)
        why = "the velocity is its derivative" + (f", times {factor:.3g}" if error > _NEAR else "")
        sure = 0.93 if error < _NEAR else 0.8 if error < _ROUGH else 0.5
        for column, name, unit in (("position", where, "m"), ("velocity", speed, "m/s")):
            own = log.signals[name].unit
            columns[f"{column}_{axis}"] = Proposed(Source(name, own or unit), sure, why)
    return columns


def _size(signal: Signal) -> float:
    """Return the factor of a signal's declared unit to that of the contract; 1 where none is declared."""
    found = conversion(signal.unit) if signal.unit else None
    return found[1] if found else 1.0


def _slopes(position: Sequence[Signal], velocity: Sequence[Signal]) -> list[Slope]:
    slopes: Iterable[Slope | None] = (slope_of(p, v) for p, v in zip(position, velocity, strict=True))
    kept = [slope for slope in slopes if slope is not None]
    return kept if len(kept) == 3 else []


def _refusal(log: Log, columns: dict[str, Proposed]) -> str:
    places = [columns[f"position_{axis}"].source.signal for axis in _AXES if f"position_{axis}" in columns]
    if places and all(is_still(log.signals[name], 1.0) for name in places):
        return "does not fly: the position stays within its noise; record a flight"
    return ""
