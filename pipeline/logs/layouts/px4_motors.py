"""The motors and the battery of PX4: commands, speeds, their order, and their range."""

from collections.abc import Sequence

import numpy as np

from simgap.logs.layouts.airframes import PLUS, Rotor, X, geometry_note, order_note, places_of
from simgap.logs.layouts.choices import Choice, choose, middle, number, rate_of
from simgap.logs.log import Log
from simgap.logs.proposal import Proposed

_ROTORS = range(4)
_MOTOR_1 = 101  # PWM_MAIN_FUNC and esc.actuator_function of motor 1
_CHANNELS = 16
_PWM = (800.0, 2200.0)  # µs; what a servo pulse can be
_DEFAULT = (1000.0, 2000.0)  # µs; PWM_MAIN_MIN and PWM_MAIN_MAX where nothing else is set
_NO_BATTERY = 1.0  # V; what a board without a power module reports is near 0


def commands(log: Log, notes: list[str]) -> Choice | None:
    """Return where the commands of the motors are, from 0 to 1."""
    direct = Choice(
        [f"actuator_motors.control[{rotor}]" for rotor in _ROTORS],
        "PX4 defines it, from 0 to 1",
        held=True,
    )
    if choose(log, [direct]) is None:
        return _pulses(log, notes)
    factor = number(log, "THR_MDL_FAC") or 0.0
    if factor:
        notes.append(
            f"THR_MDL_FAC is {factor:g}: actuator_motors is then nearer to a thrust than to a speed, "
            "and the motors get about its square root (root: true in the mapping)."
        )
        return Choice(direct.signals, f"a thrust, as THR_MDL_FAC is {factor:g}", confidence=0.7, held=True)
    return direct


def _pulses(log: Log, notes: list[str]) -> Choice | None:
    """Return the commands of pulses to the speed controllers: the first output of which four are pulses."""
    for topic in ("actuator_outputs", "actuator_outputs[1]", "actuator_outputs[2]"):
        channels = _channels(log)
        signals = [f"{topic}.output[{channel}]" for channel in channels]
        if choose(log, [Choice(signals, "")]) is None:
            continue
        if not all(_PWM[0] <= middle(log, name) <= _PWM[1] for name in signals):
            continue
        (low, high), known = _range(log)
        if not known:
            notes.append("The range of the pulses is not in the log: 1000 to 2000 µs is taken for 0 to 1.")
        return Choice(
            signals,
            f"pulses of {low:.0f} to {high:.0f} µs",
            confidence=0.9 if known else 0.6,
            scales=[1.0 / (high - low)] * 4,
            offsets=[-low / (high - low)] * 4,
            unit="1",
            held=True,
        )
    return None


def _channels(log: Log) -> list[int]:
    """Return the outputs of motors 1 to 4: those that the parameters name, else the first four."""
    functions = {number(log, f"PWM_MAIN_FUNC{channel + 1}"): channel for channel in range(_CHANNELS)}
    named = [functions.get(float(_MOTOR_1 + rotor)) for rotor in _ROTORS]
    return [channel for channel in named if channel is not None] if None not in named else list(_ROTORS)


def _range(log: Log) -> tuple[tuple[float, float], bool]:
    """Return the pulses of command 0 and 1, and whether the log says them: by name of 1.13, of 1.12, of before."""
    for low, high in (
        ("PWM_MAIN_MIN1", "PWM_MAIN_MAX1"),
        ("PWM_MAIN_MIN", "PWM_MAIN_MAX"),
        ("PWM_MIN", "PWM_MAX"),
    ):
        found = number(log, low), number(log, high)
        if found[0] is not None and found[1] is not None and _PWM[0] <= found[0] < found[1] <= _PWM[1]:
            return (found[0], found[1]), True
    return _DEFAULT, False


def speeds(log: Log) -> Choice | None:
    """Return where the speeds of the motors are; None where they are not."""
    slots = {int(middle(log, f"esc_status.esc[{slot}].actuator_function")): slot for slot in range(8)}
    order = [slots.get(_MOTOR_1 + rotor, rotor) for rotor in _ROTORS]
    signals = [f"esc_status.esc[{slot}].esc_rpm" for slot in order]
    turning = [np.sign(middle_of_turning(log, name)) for name in signals]
    if not all(turning):
        return None
    return Choice(signals, "of the speed controllers", [int(sign) for sign in turning], "rpm")


def middle_of_turning(log: Log, name: str) -> float:
    """Return the median of a speed while it is not zero; 0 where it always is."""
    values = log.signals[name].values if name in log.signals else np.empty(0)
    turning = values[np.isfinite(values) & (values != 0)]
    return float(np.median(turning)) if len(turning) else 0.0


def battery(log: Log, missing: dict[str, str]) -> dict[str, Proposed]:
    """Return the voltage of the first battery that has one."""
    for topic in ("battery_status", "battery_status[1]", "battery_status[2]"):
        name = f"{topic}.voltage_v"
        if rate_of(log, name) and middle(log, name) > _NO_BATTERY:
            return Choice([name], "PX4 defines it", unit="V").columns(["battery_voltage"])
    missing["battery_voltage"] = (
        "the log has no voltage: without a power module the sag of the battery is not seen"
    )
    return {}


def places(log: Log) -> tuple[tuple[int, int], ...]:
    """Return the signs of x and y of each motor, by the geometry in the log, else by the airframe."""
    positions = _geometry(log)
    if positions is None:
        return places_of(_airframe(log))
    return tuple(((x > 0) - (x < 0), (y > 0) - (y < 0)) for x, y, _ in positions)


def order(log: Log) -> str:
    """Return how the motors are counted: by the geometry in the log, else by the airframe."""
    positions = _geometry(log)
    if positions is None:
        return order_note(_airframe(log))
    return geometry_note(positions, [-1 if moment > 0 else 1 for moment in _moments(log)])


def _geometry(log: Log) -> list[list[float]] | None:
    """Return the positions of the rotors, body frame, m; None where the log does not say them."""
    found = [[number(log, f"CA_ROTOR{rotor}_P{axis}") or 0.0 for axis in "XYZ"] for rotor in _ROTORS]
    flat = [abs(value) for place in found for value in place[:2]]
    if not all(_moments(log)) or not any(flat) or set(flat) == {1.0}:  # 1 stands for a square of any size
        return None
    return [[x, -y + 0.0, -z + 0.0] for x, y, z in found]


def _moments(log: Log) -> list[float]:
    return [number(log, f"CA_ROTOR{rotor}_KM") or 0.0 for rotor in _ROTORS]


def _airframe(log: Log) -> Sequence[Rotor]:
    return PLUS if 5000 <= (number(log, "SYS_AUTOSTART") or 0) < 6000 else X
