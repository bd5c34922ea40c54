"""The motors and the battery of ArduPilot: commands, speeds, their order, and their range."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from simgap.logs.layouts.airframes import ARDUPILOT, Rotor, X, order_note
from simgap.logs.layouts.choices import Choice, choose, middle, number, rate_of
from simgap.logs.layouts.rates import SLOWEST
from simgap.logs.log import Log, Signal, Span
from simgap.logs.proposal import Proposed
from simgap.logs.readers.dataflash_mixer import PREFIX, agreement

_ROTORS = range(4)
_MOTOR_1 = 33  # SERVO_FUNCTION of motor 1
_CHANNELS = 32
_DEFAULT = (1000.0, 2000.0)  # µs; MOT_PWM_MIN and MOT_PWM_MAX where nothing else is set
_WHOLE_VOLTS = 100.0  # V; more has no such vehicle, so that more is hundredths, as before 2016
_AGREEMENT = 0.98  # R²; an error of a seventh of how much the pulses vary
_NO_BATTERY = 1.0  # V; without a monitor it is 0


def commands(log: Log, windows: Sequence[Span], notes: list[str]) -> Choice | None:
    """Return where the commands of the motors are, from 0 to 1.

    Args:
        log: as it was read.
        windows: the flights, in which pulses of the rate controller must agree with those that were logged.
        notes: to which what a person should know is added.
    """
    channels = _channels(log)
    choices = [
        Choice([f"RCOU.{prefix}{channel}" for channel in channels], "") for prefix in ("C", "Ch", "Chan")
    ]
    found = choose(log, choices)
    if found is None:
        return None
    if rate_of(log, found.signals[0]) < SLOWEST:
        found = _computed(log, found, windows, notes)
    (low, high), known = _range(log)
    if not known:
        notes.append("The range of the pulses is not in the log: 1000 to 2000 µs is taken for 0 to 1.")
    return Choice(
        found.signals,
        f"pulses of {low:.0f} to {high:.0f} µs",
        confidence=0.9 if known else 0.6,
        scales=[1.0 / (high - low)] * 4,
        offsets=[-low / (high - low)] * 4,
        unit="1",
        held=True,
    )


def _computed(log: Log, logged: Choice, windows: Sequence[Span], notes: list[str]) -> Choice:
    """Return the same pulses at the rate of the rate controller, where they agree; else the logged ones."""
    names = [PREFIX + name.removeprefix("RCOU.") for name in logged.signals]
    if not windows or not all(name in log.signals for name in names):
        return logged
    worst = min(
        agreement(told, log.signals[name], _inside(told, windows))
        for told, name in zip(map(log.signals.__getitem__, logged.signals), names, strict=True)
    )
    if worst < _AGREEMENT:
        return logged
    notes.append(
        f"RCOU at {rate_of(log, logged.signals[0]):.0f} Hz is too slow. The pulses are computed of what the rate "
        f"controller gave the mixer (RATE); they agree with RCOU to R² {worst:.3f}, of samples that were not fitted."
    )
    return Choice(names, logged.reason)


def _inside(signal: Signal, windows: Sequence[Span]) -> NDArray[np.bool_]:
    inside = np.zeros(len(signal.time), dtype=bool)
    for window in windows:
        inside |= (signal.time >= window.begin) & (signal.time <= window.end)
    return inside


def _channels(log: Log) -> list[int]:
    """Return the outputs of motors 1 to 4: those that the parameters name, else the first four."""
    functions = {number(log, f"SERVO{channel}_FUNCTION"): channel for channel in range(1, _CHANNELS + 1)}
    named = [functions.get(float(_MOTOR_1 + rotor)) for rotor in _ROTORS]
    return [channel for channel in named if channel is not None] if None not in named else [1, 2, 3, 4]


def _range(log: Log) -> tuple[tuple[float, float], bool]:
    """Return the pulses of command 0 and 1, and whether the log says them: the motors', else those of the throttle."""
    for low, high in (("MOT_PWM_MIN", "MOT_PWM_MAX"), ("RC3_MIN", "RC3_MAX")):
        found = number(log, low), number(log, high)
        if found[0] and found[1] and found[0] < found[1]:
            return (found[0], found[1]), True
    return _DEFAULT, False


def speeds(log: Log) -> Choice | None:
    """Return where the speeds of the motors are; None where they are not."""
    for pattern in (
        lambda slot: f"ESC[{slot}].RPM" if slot else "ESC.RPM",
        lambda slot: f"ESC{slot + 1}.RPM",
    ):
        signals = [pattern(channel - 1) for channel in _channels(log)]
        if all(rate_of(log, name) and np.any(log.signals[name].values > 0) for name in signals):
            return Choice(signals, "of the speed controllers", unit="rpm")
    return None


def battery(log: Log, missing: dict[str, str]) -> dict[str, Proposed]:
    """Return the voltage of the battery, where one is monitored."""
    for name in ("BAT.Volt", "CURR.Volt"):
        volts = middle(log, name) if rate_of(log, name) else 0.0
        if volts > _NO_BATTERY:
            scale = 1.0 if volts < _WHOLE_VOLTS else 0.01
            reason = "ArduPilot defines it" if scale == 1.0 else "in hundredths of a volt"
            return Choice([name], reason, unit="V", scales=[scale]).columns(["battery_voltage"])
    missing["battery_voltage"] = (
        "the log has no voltage: without a battery monitor (BATT_MONITOR) the sag of the battery is not seen"
    )
    return {}


def rotors(log: Log) -> Sequence[Rotor]:
    """Return the rotors in the order of the log, by the type of the frame; none where it is not known."""
    kind = number(log, "FRAME_TYPE")
    kind = kind if kind is not None else number(log, "FRAME")
    return ARDUPILOT.get(int(kind), ()) if kind is not None else ()


def order(log: Log) -> str:
    """Return how the motors are counted, of the type of the frame."""
    found = rotors(log)
    return (
        order_note(found) if found else f"The frame is not one that is known; if it is an X: {order_note(X)}"
    )
