"""Flights logged by Betaflight or INAV: rates, accelerometer, motors and battery, but no position."""

from collections.abc import Iterator

import numpy as np

from simgap.logs.common_times import step_of
from simgap.logs.layouts.airframes import BETAFLIGHT_X, places_note, places_of
from simgap.logs.layouts.powered import flights_of, full_thrust
from simgap.logs.layouts.quad_x import Turning, directions_of, turning_of
from simgap.logs.log import Log, Signal, Span
from simgap.logs.mapping import Source
from simgap.logs.proposal import Proposal, Proposed

_AXES = "xyz"
_LONGEST_STEP = 0.02  # s between two frames; slower logs show no motor lag
_RATE = 200.0  # samples per second: ten in the time constant of a motor, which is 20 to 50 ms
_DIGITAL = (48.0, 2047.0)  # values of DSHOT that mean no and full throttle
_ANALOGUE = (1000.0, 2000.0)  # µs of a pulse
_DEFINED, _LIKELY, _OPPOSED = 0.95, 0.7, 0.4
_PER_POLE_PAIR = 2.0
_STANDARD_GRAVITY = 9.80665  # m/s², the g of accelerometers
_USUAL_POLES = 14.0  # of a motor of a racing quadrotor, and the firmware's own default


def propose(log: Log, kind: str | None) -> Proposal | None:
    """Propose the mapping of a blackbox log to a quadrotor; None for another log."""
    if log.format != "Blackbox":
        return None
    motors = sorted(name for name in log.signals if name.startswith("motor["))
    if kind not in (None, "quadrotor") or len(motors) != 4:
        what = f"has {len(motors)} motors" if len(motors) != 4 else "is the log of a flight controller"
        return Proposal(
            "quadrotor", {}, refusal=f"{what}: only flights of quadrotors with four motors are read"
        )
    if "gyroADC[0]" not in log.signals:
        missing = {
            "body_rate_x": "let the blackbox log the gyroscope (blackbox_disable_gyro = OFF), and fly again"
        }
        return Proposal("quadrotor", {}, missing=missing)
    low, high = motor_range(log)
    # Each axis and motor in one piece of memory.
    motion = np.stack([log.signals[f"gyroADC[{axis}]"].values for axis in range(3)]).T
    commands = np.stack([log.signals[name].values for name in motors]).T
    commands -= low
    commands /= high - low
    np.clip(commands, 0, 1, out=commands)
    time = log.signals[motors[0]].time
    flights = flights_of(log, time, commands)
    if not flights:
        refusal = "no flight is in it: the throttle never stays up long enough; log a flight of at least ten seconds"
        return Proposal("quadrotor", {}, refusal=refusal)
    turning = turning_of(time, np.radians(motion), commands, flights)
    columns = {**_rates(log, turning), **_forces(log), **_motors(log, low, high), **_battery(log)}
    step = step_of(time)
    return Proposal(
        "quadrotor",
        columns,
        windows=flights,
        notes=(*_notes(log, turning, step), *_strength(log, time, commands, flights)),
        rate=_RATE if step * _RATE < 1.0 else None,
        places=places_of(BETAFLIGHT_X),
    )


def motor_range(log: Log) -> tuple[float, float]:
    """Return the motor values of a log that mean no and full throttle: those of DSHOT, or of a pulse in µs."""
    limits = [float(text) for text in log.facts.get("motorOutput", "").split(",") if _is_number(text)]
    return _DIGITAL if limits and limits[-1] > _ANALOGUE[1] else _ANALOGUE


def _is_number(text: str) -> bool:
    return text.strip().lstrip("-").replace(".", "", 1).isdigit()


def _rates(log: Log, turning: Turning) -> dict[str, Proposed]:
    known = _DEFINED if "Betaflight" in log.facts.get("Firmware revision", "") else _LIKELY
    columns = {}
    for axis, name in enumerate(_AXES):
        confidence, reason = known, "the firmware's body frame: x forward, y left, z up"
        if axis < 2 and turning.agrees(axis):
            confidence, reason = _DEFINED, f"{reason}; the motors turn it that way"
        elif axis < 2 and turning.opposes(axis):
            confidence, reason = (
                _OPPOSED,
                "the motors of a quad X turn it the other way: another order, or frame?",
            )
        columns[f"body_rate_{name}"] = Proposed(
            Source(f"gyroADC[{axis}]", _unit(log, f"gyroADC[{axis}]", "deg/s")), confidence, reason
        )
        command = next((stem for stem in ("setpoint", "axisRate") if f"{stem}[{axis}]" in log.signals), None)
        if command is not None:
            source = Source(f"{command}[{axis}]", "deg/s")
            columns[f"body_rate_command_{name}"] = Proposed(
                source, known, "what the rate controller is asked for"
            )
    return columns


def _forces(log: Log) -> dict[str, Proposed]:
    if log.signals.get("accSmooth[2]", Signal("", np.empty(0), np.empty(0))).unit != "g":
        return {}
    known = _DEFINED if "Betaflight" in log.facts.get("Firmware revision", "") else _LIKELY
    return {
        f"specific_force_{name}": Proposed(
            Source(f"accSmooth[{axis}]", "g"), known, "accelerometer by acc_1G; at rest it reads +1 g along z"
        )
        for axis, name in enumerate(_AXES)
    }


def _motors(log: Log, low: float, high: float) -> dict[str, Proposed]:
    span, columns = high - low, {}
    for motor in range(4):
        source = Source(f"motor[{motor}]", "1", scale=1.0 / span, offset=-low / span)
        columns[f"motor_command_{motor + 1}"] = Proposed(source, _DEFINED, f"throttle, {low:g} to {high:g}")
    poles = log.facts.get("motor_poles", "")
    if "eRPM[0]" in log.signals and np.any(log.signals["eRPM[0]"].values > 0):
        number, known = (float(poles), _DEFINED) if _is_number(poles) else (_USUAL_POLES, _LIKELY)
        for motor in range(4):
            source = Source(f"eRPM[{motor}]", "rpm", scale=_PER_POLE_PAIR / number)
            reason = f"electrical turns of a motor with {number:g} poles"
            columns[f"motor_speed_{motor + 1}"] = Proposed(source, known, reason)
    return columns


def _battery(log: Log) -> dict[str, Proposed]:
    name = next((name for name in ("vbatLatest", "vbat") if name in log.signals), None)
    if name is None or log.signals[name].unit != "V" or not np.any(log.signals[name].values > 0):
        return {}
    return {"battery_voltage": Proposed(Source(name, "V"), _DEFINED, "battery, by the firmware's own scale")}


def _strength(log: Log, time: np.ndarray, commands: np.ndarray, flights: tuple[Span, ...]) -> Iterator[str]:
    """Yield what the log says of three numbers of the platform file that few people know."""
    force = log.signals.get("accSmooth[2]")
    if force is None or force.unit != "g" or len(force.values) != len(time):
        return
    strength = full_thrust(time, _STANDARD_GRAVITY * force.values, commands, flights)
    if strength is not None and strength > 0.0:
        volts = _mean_voltage(log, time, flights)
        yield (
            f"thrust_coefficient · motor_speed_max² / mass is near {strength:.3g} m/s² in these flights"
            f"{f', at {volts:.3g} V on average' if volts else ''}: choose the three numbers of the platform file so"
            f"{', and nominal_voltage' if volts else ''}, if you do not know them better."
        )


def _mean_voltage(log: Log, time: np.ndarray, flights: tuple[Span, ...]) -> float | None:
    """Return the mean voltage of the battery in the flights; None where it was not logged at these times."""
    battery = _battery(log).get("battery_voltage")
    values = log.signals[battery.source.signal].values if battery else time[:0]
    if len(values) != len(time):
        return None
    flown = np.zeros(len(time), dtype=bool)
    for flight in flights:
        flown |= (time >= flight.begin) & (time <= flight.end)
    return float(values[flown].mean())


def _unit(log: Log, name: str, usual: str) -> str:
    return log.signals[name].unit or usual


def _notes(log: Log, turning: Turning, step: float) -> Iterator[str]:
    """Yield what the platform file has to say, and what a better log would hold."""
    yield places_note(BETAFLIGHT_X)
    yield directions_of(turning)
    if step > _LONGEST_STEP:
        yield f"One frame every {step:.3g} s shows no motor lag: set blackbox_sample_rate to 500 Hz or more."
    if "eRPM[0]" not in log.signals:
        yield (
            "Rotor speeds are not in it: with bidirectional DSHOT (dshot_bidir = ON) and blackbox_disable_rpm = OFF "
            "they tell a lag of the motors from a wrong thrust coefficient."
        )
    if "accSmooth[2]" not in log.signals:
        yield "The accelerometer is not in it (blackbox_disable_acc = OFF), so that the thrust cannot be judged."
    if not _battery(log):
        yield "The battery voltage is not in it, or in no known unit, so that sag can only be guessed."
