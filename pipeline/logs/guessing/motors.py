"""The four motors of a quadrotor: commands in one of the usual ranges, or speeds."""

import numpy as np

from simgap.logs.guessing.vectors import Vector, vectors_of
from simgap.logs.guessing.words import Said
from simgap.logs.log import Log, Signal
from simgap.logs.mapping import Source
from simgap.logs.proposal import Proposed
from simgap.recordings.units import conversion

_WORDS = frozenset((
    "m", "motor", "motors", "rotor", "rotors", "esc", "pwm", "rpm", "erpm", "thrust", "throttle",
    "actuator", "out", "output", "u",
))  # fmt: skip
_SPEED_WORDS = frozenset(("rpm", "speed", "omega", "velocity"))
_PULSE = (900.0, 2100.0)  # µs, of servo pulses
_SIXTEEN_BITS = 65535.0


def motors_of(log: Log, said: dict[str, Said]) -> dict[str, Proposed]:
    """Propose motor_command_1 to 4 or motor_speed_1 to 4; empty where no four signals of motors are there.

    Args:
        log: with times in s.
        said: what the names of its signals say.
    """
    columns: dict[str, Proposed] = {}
    for vector in vectors_of(said):
        if vector.axes not in ("1234", "0123") or not vector.words & _WORDS:
            continue
        parts = [log.signals[name] for name in vector.names]
        found = _proposed(vector, parts)
        if found is None:
            continue
        column, unit, scale, offset, sure, why = found
        if f"{column}_1" not in columns or columns[f"{column}_1"].confidence < sure:
            for number, part in enumerate(parts, 1):
                source = Source(part.name, unit, scale, offset=offset)
                columns[f"{column}_{number}"] = Proposed(source, sure, why)
    return columns


def _proposed(vector: Vector, parts: list[Signal]) -> tuple[str, str | None, float, float, float, str] | None:
    """Return column, unit, scale, offset, confidence and reason of four signals; None where they are no motors."""
    values = np.concatenate([part.values for part in parts])
    values = values[np.isfinite(values)]
    if not len(values) or np.ptp(values) == 0.0 or values.min() < -1e-6:
        return None
    declared = conversion(parts[0].unit) if parts[0].unit else None
    largest = float(values.max())
    if declared is not None and declared[0] == "rad/s" and "erpm" not in vector.words:
        return "motor_speed", parts[0].unit, 1.0, 0.0, 0.95, f"speeds in {parts[0].unit}"
    if "erpm" in vector.words or (declared is not None and declared[0] not in ("1", "s")):
        return None  # of a magnetic field, whose number of poles is not in a log; or no command nor pulse
    if vector.words & _SPEED_WORDS:
        return "motor_speed", "rad/s", 1.0, 0.0, 0.6, "by its name; no unit is said"
    if largest <= 1.0:
        power = "thrust" in vector.words
        why = "from 0 to 1; is it a thrust, the square of a speed?" if power else "from 0 to 1"
        return "motor_command", None, 1.0, 0.0, 0.75 if power else 0.9, why
    if largest <= 100.0 and declared is not None:
        return "motor_command", parts[0].unit, 1.0, 0.0, 0.9, f"in {parts[0].unit}"
    if _PULSE[0] <= float(np.median(values[values > 0])) <= _PULSE[1] and largest <= _PULSE[1]:
        return "motor_command", "1", 1e-3, -1.0, 0.85, "pulses of 1000 to 2000 µs"
    if _PULSE[1] < largest <= _SIXTEEN_BITS:
        return (
            "motor_command",
            "1",
            1.0 / _SIXTEEN_BITS,
            0.0,
            0.75,
            "numbers of 16 bits: 65535 is taken for full",
        )
    return None
