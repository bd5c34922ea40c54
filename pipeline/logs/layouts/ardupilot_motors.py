"""The motors and the battery of ArduPilot: commands, speeds, their order, and their range."""

import numpy as np

from simgap.logs.layouts.airframes import ARDUPILOT, X, order_note
from simgap.logs.layouts.choices import Choice, choose, middle, number, rate_of
from simgap.logs.log import Log
from simgap.logs.proposal import Proposed

_ROTORS = range(4)
_MOTOR_1 = 33  # SERVO_FUNCTION of motor 1
_CHANNELS = 32
_DEFAULT = (1000.0, 2000.0)  # µs; MOT_PWM_MIN and MOT_PWM_MAX where nothing else is set
_WHOLE_VOLTS = 100.0  # V; more has no such vehicle, so that more is hundredths, as before 2016
_NO_BATTERY = 1.0  # V; without a monitor it is 0


def commands(log: Log, notes: list[str]) -> Choice | None:
    """Return where the commands of the motors are, from 0 to 1."""
    channels = _channels(log)
    choices = [
        Choice([f"RCOU.{prefix}{channel}" for channel in channels], "") for prefix in ("C", "Ch", "Chan")
    ]
    found = choose(log, choices)
    if found is None:
        return None
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


def order(log: Log) -> str:
    """Return how the motors are counted, of the type of the frame."""
    kind = number(log, "FRAME_TYPE")
    kind = kind if kind is not None else number(log, "FRAME")
    rotors = ARDUPILOT.get(int(kind)) if kind is not None else None
    if rotors is None:
        return f"The frame is not one that is known; if it is an X: {order_note(X)}"
    return order_note(rotors)
