"""What may have been done to the recording of a quadrotor."""

from itertools import permutations

import numpy as np

from simgap.consistency.frames import frame_faults
from simgap.consistency.rotors import TURNED
from simgap.consistency.samples import Samples
from simgap.consistency.transformation import Transformation, mapping, scaled, taken
from simgap.consistency.units import ANGULAR_RATE, CLOCK, FORCE, LENGTH, SPEED, in_two_units, in_units

_ORDER = 0.008  # each of the 23 other orders of four motors; together as likely as all else
_THRUST = 0.04
_DIRECTIONS = 0.04  # racers fly with propellers either way round
_MOTOR_UNITS = (
    ("turns_per_minute", 30.0 / np.pi, 0.06, "unit: rpm"),
    ("rotations", 0.5 / np.pi, 0.03, "unit: rev/s"),
)
_FULL = ((100.0, 0.05), (255.0, 0.02), (1000.0, 0.03), (2000.0, 0.02), (2047.0, 0.02), (65535.0, 0.04))
_LEAST_COMMAND = 0.3  # largest command of a flight, at least
_PULSE = (1000.0, 1000.0)  # µs of a servo pulse: the least, and what full command adds


def quadrotor_faults(samples: Samples) -> list[Transformation]:
    """Return the transformations of a quadrotor's columns."""
    position, velocity, rate = (_three(stem) for stem in ("position", "velocity", "body_rate"))
    found = [
        *in_units("position", position, LENGTH),
        *in_units("velocity", velocity, SPEED),
        *in_two_units("position and velocity", ((position, LENGTH), (velocity, SPEED))),
        *in_units("body_rate", rate, ANGULAR_RATE),
        *in_units("t", ("t",), CLOCK),
        *frame_faults(samples),
    ]
    if samples.has("specific_force", "xyz"):
        found += in_units("specific_force", _three("specific_force"), FORCE)
    if samples.has("body_rate_command", "xyz"):
        found += in_units("body_rate_command", _three("body_rate_command"), ANGULAR_RATE)
    return found + _motors(samples)


def _three(stem: str) -> tuple[str, ...]:
    return tuple(f"{stem}_{axis}" for axis in "xyz")


def _motors(samples: Samples) -> list[Transformation]:
    stems = [stem for stem in ("motor_speed", "motor_command") if samples.has(stem, "1234")]
    found = []
    groups = dict.fromkeys([tuple(stems), *((stem,) for stem in stems)])
    for group in groups:
        name = " and ".join(f"{stem}_1..4" for stem in group)
        for order in permutations("1234"):
            sources = {
                f"{stem}_{here}": f"{stem}_{there}"
                for stem in group
                for here, there in zip("1234", order, strict=True)
            }
            if "".join(order) != "1234":
                words = f"numbered {', '.join(order)} where the platform file has 1, 2, 3, 4"
                share = 1.0 if len(group) == len(stems) else 0.2
                found.append(taken("motor_order", name, sources, share * _ORDER, words))
    if "motor_speed" in stems:
        found += in_units("motor_speed_1..4", _four("motor_speed"), _MOTOR_UNITS)
    if stems:
        found.append(_turned(tuple(column for stem in stems for column in _four(stem))))
    return found + (_commands(samples) if "motor_command" in stems else [])


def _four(stem: str) -> tuple[str, ...]:
    return tuple(f"{stem}_{rotor}" for rotor in "1234")


def _turned(columns: tuple[str, ...]) -> Transformation:
    """Return the transformation in which all rotors turn the other way than the platform file says."""

    def mend(samples: Samples) -> dict[str, np.ndarray]:
        return {TURNED: np.full(len(samples["t"]), -1.0)}

    remedy = "Change the four signs of rotor_directions in the platform file."
    return Transformation("sign", TURNED, columns, _DIRECTIONS, mend, remedy)


def _commands(samples: Samples) -> list[Transformation]:
    """Return the scales of a command that its values allow."""
    name, columns = "motor_command_1..4", _four("motor_command")
    values = samples.stack("motor_command", "1234")
    least, largest = np.nanquantile(values, [0.01, 0.99])
    found = [
        scaled(
            "percent" if whole == 100.0 else "full_scale",
            name,
            columns,
            whole,
            odds,
            f"scale: {1.0 / whole:.4g}",
        )
        for whole, odds in _FULL
        if _LEAST_COMMAND * whole < largest <= 1.01 * whole
    ]
    if 0.9 * _PULSE[0] < least and largest < 1.1 * sum(_PULSE):
        found.append(_pulse(name, columns))
    return [*found, *([_thrust(name, columns)] if largest <= 1.01 else [])]


def _pulse(name: str, columns: tuple[str, ...]) -> Transformation:
    def mend(samples: Samples) -> dict[str, np.ndarray]:
        return {column: (samples[column] - _PULSE[0]) / _PULSE[1] for column in columns}

    remedy = mapping(columns, f"scale: {1 / _PULSE[1]:g}, offset: {-_PULSE[0] / _PULSE[1]:g}")
    return Transformation("pulse_width", name, columns, 0.05, mend, remedy)


def _thrust(name: str, columns: tuple[str, ...]) -> Transformation:
    """Return the transformation in which a command is a share of the thrust, which is the square of the speed's."""

    def mend(samples: Samples) -> dict[str, np.ndarray]:
        return {column: np.sqrt(np.maximum(samples[column], 0.0)) for column in columns}

    remedy = mapping(columns, "root: true")
    return Transformation("thrust_command", name, columns, _THRUST, mend, remedy)
