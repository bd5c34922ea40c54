"""Synthetic logs of a joint as many people would write them, with the mapping that is right for each."""

from dataclasses import dataclass

import numpy as np
import pandas as pd

POSITIONS = (
    "pos", "position", "angle", "theta", "q", "encoder_position", "joint_angle", "motorPosition", "actual_position",
    "PositionActual", "shaft angle", "elbow/position", "pos_estimate", "present_position", "Encoder.Position",
)  # fmt: skip
VELOCITIES = (
    "vel", "velocity", "omega", "qd", "dq", "speed", "encoder_velocity", "joint_velocity", "motorVelocity",
    "actual_velocity", "VelocityActual", "angular velocity", "elbow/velocity", "vel_estimate", "theta_dot",
)  # fmt: skip
EFFORTS = ("torque", "tau", "effort", "tau_measured", "jointTorque", "measured torque", "motor/torque", "trq")
VOLTAGES = ("voltage", "motor_voltage", "appliedVolts", "volts", "input voltage", "motor/voltage")
TIMES = ("t", "time", "timestamp", "Time", "time_stamp", "elapsed time", "clock")
BATTERIES = ("vbat", "battery_voltage", "battery", "supply voltage", "busVoltage", "VBus")
OTHERS = (
    "error",
    "loop_hz",
    "index",
    "acceleration",
    "position_target",
    "velocity_command",
    "temp",
    "kp",
    "comment",
)

ANGLES = {"rad": 1.0, "deg": np.pi / 180, "rev": 2 * np.pi}
RATES = {"rad/s": 1.0, "deg/s": np.pi / 180, "rpm": 2 * np.pi / 60, "rev/s": 2 * np.pi}
CLOCKS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
SUFFIXES = {
    "rad": "_rad", "deg": "_deg", "rev": "_rev", "rad/s": "_rad_s", "deg/s": "_deg_s", "rpm": "_rpm", "rev/s": "_rps",
    "s": "_sec", "ms": "_ms", "us": "_us", "ns": "_ns", "N·m": "_nm", "V": "_volts",
}  # fmt: skip
BRACKETS = ("{} [{}]", "{} ({})", "{}[{}]", "{} {{{}}}")


@dataclass(frozen=True)
class Made:
    """A log and what is right.

    Attributes:
        frame: the table.
        columns: column of the contract to the name of its column and the factor to the contract's unit.
    """

    frame: pd.DataFrame
    columns: dict[str, tuple[str, float]]


def make(rng: np.random.Generator, samples: int = 700) -> Made:
    """Make a log with names, units, order of columns and distractors drawn by chance."""
    time, position, velocity = motion(rng, samples)
    effort = 0.3 * np.sign(velocity) + 0.05 * velocity + 0.02 * rng.standard_normal(samples)
    number = int(rng.integers(len(POSITIONS)))
    clock = pick(rng, CLOCKS)
    angle, rate = pick(rng, ANGLES), pick(rng, RATES)
    style = int(rng.integers(3))
    parts = [
        ("t", TIMES, (time + (1.7e9 if rng.random() < 0.3 else 0.0)), clock, CLOCKS[clock]),
        ("position", (POSITIONS[number],), position, angle, ANGLES[angle]),
        ("velocity", (VELOCITIES[number],), velocity, rate, RATES[rate]),
    ]
    if rng.random() < 0.5:
        parts.append(("effort", EFFORTS, effort, "N·m", 1.0))
    else:
        parts.append(("voltage", VOLTAGES, 20.0 * effort, "V", 1.0))
        parts.append(("battery_voltage", BATTERIES, 12.0 - 0.3 * np.abs(effort), "V", 1.0))
    columns, data = {}, {}
    for column, names, values, unit, factor in parts:
        name = titled(rng, str(rng.choice(names)), unit, style)
        stored = np.round(values / factor) if column == "t" and unit != "s" else values / factor
        columns[column], data[name] = (name, factor), stored
    data |= distractors(rng, time, position)
    order = rng.permutation(list(data))
    return Made(pd.DataFrame({name: data[name] for name in order}), columns)


def motion(rng: np.random.Generator, samples: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return time, position and velocity of a joint: three sines, with the noise of a sensor."""
    step = float(rng.choice([0.002, 0.005, 0.01, 0.02]))
    time = np.arange(samples) * step + 0.02 * step * rng.standard_normal(samples)
    time -= time[0]
    sizes, turns = rng.uniform(0.2, 1.0, 3), rng.uniform(0.5, 3.0, 3)
    phases = rng.uniform(0, 6, 3)
    position = (sizes * np.sin(turns * time[:, None] + phases)).sum(axis=1)
    velocity = (sizes * turns * np.cos(turns * time[:, None] + phases)).sum(axis=1)
    return (
        time,
        position + 1e-4 * rng.standard_normal(samples),
        velocity + 1e-2 * rng.standard_normal(samples),
    )


def titled(rng: np.random.Generator, name: str, unit: str, style: int) -> str:
    """Return a name with its unit in brackets (style 0), as an ending (1), or without."""
    if style == 0:
        return str(rng.choice(BRACKETS)).format(name, unit)
    return name + SUFFIXES[unit] if style == 1 else name


def distractors(rng: np.random.Generator, time: np.ndarray, position: np.ndarray) -> dict[str, np.ndarray]:
    """Return columns that are none of those that are needed."""
    count = len(time)
    content = {
        "error": 0.01 * rng.standard_normal(count),
        "loop_hz": 100 + rng.standard_normal(count),
        "index": np.arange(count),
        "acceleration": rng.standard_normal(count),
        "position_target": position + 0.05,
        "velocity_command": np.sin(time),
        "temp": 30 + time / 10,
        "kp": np.full(count, 5.0),
        "comment": np.full(count, "ok", dtype=object),
    }
    return {name: content[name] for name in rng.choice(OTHERS, int(rng.integers(0, 5)), replace=False)}


def pick(rng: np.random.Generator, among: dict[str, float]) -> str:
    """Draw a key."""
    return str(rng.choice(list(among)))
