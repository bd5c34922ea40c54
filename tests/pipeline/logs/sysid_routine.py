"""A SysId routine on a concealed drivetrain: open-loop ramps and steps of voltage, logged as WPILib does."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from simgap.plants.joint.axis import axis_of
from simgap.plants.joint.case import JointCase
from simgap.plants.joint.drive import drive_of
from simgap.platforms import Joint
from tests.pipeline.logs.wpilog_encoder import Writer

STEP, CYCLE = 1e-3, 0.02  # s, of the simulation and of the robot's program
TESTS = ("quasistatic-forward", "quasistatic-reverse", "dynamic-forward", "dynamic-reverse")
RAMP, JUMP = 1.0, 7.0  # V/s and V: the defaults of WPILib's SysIdRoutine
_BEGIN = 20_000_000  # µs since the robot was switched on
DURATION = {"quasistatic": 5.0, "dynamic": 2.0}  # s


def write_routine(
    path: Path, platform: Joint, effects: Mapping[str, Mapping[str, float]], rounds: int = 2, seed: int = 0
) -> Path:
    """Write the log of a drivetrain that runs each test in several rounds.

    Args:
        path: of the log.
        platform: the machine without what is concealed.
        effects: what is concealed, as in `JointCase`.
        rounds: how often each test is run.
        seed: of the sensors' noise.
    """
    log, random = Writer(), np.random.default_rng(seed)
    state = log.start("sysid-test-state-drive", "string")
    entries = {
        name: log.start(f"{name}-side-drive", "double", unit)
        for name, unit in (("voltage", "Volt"), ("position", "Meter"), ("velocity", "Meter per Second"))
    }
    now = _BEGIN
    for test, (voltage, position, velocity) in _cycles(TESTS * rounds, platform, effects):
        measured = {
            "voltage": voltage,
            "position": 1e-3 * round(1e3 * (position + 2e-4 * random.standard_normal())),
            "velocity": velocity + 5e-3 * random.standard_normal(),
        }
        log.text(state, now, test)
        for order, (name, value) in enumerate(measured.items(), 1):
            log.double(entries[name], now + 40 * order, float(value))  # one after the other within the cycle
        now += round(CYCLE * 1e6)
    log.text(state, now, "none")
    return log.write(path)


def _cycles(
    tests: Sequence[str], platform: Joint, effects: Mapping[str, Mapping[str, float]]
) -> Iterator[tuple[str, tuple[float, float, float]]]:
    """Yield the test, and volts, position and velocity, at every cycle; a test begins while the axis still rolls."""
    case = JointCase(effects={name: dict(values) for name, values in effects.items()}, sliding=True, runs=1)
    concealed, outside = case.concealed(platform)
    drive = drive_of(concealed, platform, case, np.random.default_rng(0))
    axis = axis_of(concealed, outside, platform, case, (np.zeros(1), np.zeros(1)))
    every = round(CYCLE / STEP)
    for test in tests:
        kind, direction = test.split("-")
        sign = 1.0 if direction == "forward" else -1.0
        for cycle in range(round(DURATION[kind] / CYCLE)):
            volts = np.full(1, sign * (JUMP if kind == "dynamic" else RAMP * cycle * CYCLE))
            axis.feel(drive.effort(volts, axis.velocity[0], 0.0))
            yield test, (float(volts[0]), float(axis.position[-1][0]), float(axis.velocity[-1][0]))
            for _ in range(every):
                axis.travel(STEP)
                axis.push(drive.effort(volts, axis.foreseen[0], STEP), STEP)
