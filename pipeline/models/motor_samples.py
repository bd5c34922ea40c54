"""Voltage and speed of a single motor, from a recording of any kind."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fnmatch import fnmatchcase

import numpy as np

from simgap.errors import InputError
from simgap.models.segments import segments
from simgap.platforms import Joint, Platform
from simgap.recordings.recording import Recording

FEWEST_BLOCKS = 10
Shape = Callable[[np.ndarray], np.ndarray]
_NONE: Mapping[str, Shape] = {}


@dataclass(frozen=True)
class MotorSamples:
    """Samples of one motor.

    Attributes:
        voltage: per segment (samples,), V.
        velocity: per segment (samples,), in `speed_unit`.
        time_step: s.
        speed_unit: rad/s or m/s.
        loads: by the name of its gain, what a load that the platform tells of takes in proportion to, per segment
            (samples,): of kG the sine of the angle from hanging down, of kSpring the position.
    """

    voltage: list[np.ndarray]
    velocity: list[np.ndarray]
    time_step: float
    speed_unit: str
    loads: Mapping[str, list[np.ndarray]] = field(default_factory=dict)

    def blocks(self, duration: float) -> list[np.ndarray]:
        """Number the samples by blocks of so many seconds, at least ten in all; none spans two segments."""
        total = sum(map(len, self.voltage))
        length = max(min(round(duration / self.time_step), total // FEWEST_BLOCKS), 1)
        numbers, first = [], 0
        for samples in self.voltage:
            numbers.append(first + np.arange(len(samples)) // length)
            first = int(numbers[-1][-1]) + 1
        return numbers


def with_acting_voltage(motor: MotorSamples) -> MotorSamples:
    """Return the samples with each voltage at the sample from which it is held, whichever way it was logged.

    Some loggers record the next voltage, others the one that has acted since the previous sample. The choice that
    better predicts the next speed is taken. With slow voltages both are nearly the same.
    """
    moved = [np.append(voltage[1:], voltage[-1]) for voltage in motor.voltage]
    return min(motor, replace(motor, voltage=moved), key=_one_step_error)


def _one_step_error(motor: MotorSamples) -> float:
    now = np.concatenate([velocity[:-1] for velocity in motor.velocity])
    following = np.concatenate([velocity[1:] for velocity in motor.velocity])
    acting = np.concatenate([voltage[:-1] for voltage in motor.voltage])
    regressors = np.column_stack([np.sign(now), acting, now])
    fitted = regressors @ np.linalg.lstsq(regressors, following, rcond=None)[0]
    return float(np.sum((following - fitted) ** 2))


def motors_of(
    recording: Recording,
    runs: Sequence[str],
    patterns: Mapping[str, Sequence[str]],
    platform: Platform | None = None,
) -> Iterator[tuple[str, MotorSamples]]:
    """Yield the motors of a joint or swerve recording by name.

    Args:
        recording: cleaned, with voltages.
        runs: to take samples from.
        patterns: motor to patterns of the runs that it made, where the runs of a joint are of several motors.
        platform: what is known before; gravity and a spring of a joint are loads of its motor.

    Raises:
        InputError: when the patterns leave out a run, or take none.
    """
    if recording.kind == "swerve":
        for group in ("drive", "steer"):
            for number in range(1, 5):
                columns = (f"{group}_voltage_{number}", f"{group}_velocity_{number}")
                yield f"{group}_{number}", _samples(recording, runs, columns)
        return
    for motor, chosen in _runs_by_motor(runs, patterns).items():
        yield motor, _samples(recording, chosen, ("voltage", "velocity"), _shapes(platform))


def _shapes(platform: Platform | None) -> dict[str, Shape]:
    """Return what the loads of a joint do with its position, by the names of their gains."""
    shapes: dict[str, Shape] = {}
    if isinstance(platform, Joint) and platform.gravity_torque != 0.0:
        shapes["kG"] = np.sin
    if isinstance(platform, Joint) and platform.stiffness != 0.0:
        shapes["kSpring"] = np.positive
    return shapes


def _runs_by_motor(runs: Sequence[str], patterns: Mapping[str, Sequence[str]]) -> dict[str, list[str]]:
    if not patterns:
        return {"motor": list(runs)}
    chosen = {
        motor: [run for run in runs if any(fnmatchcase(run, pattern) for pattern in wanted)]
        for motor, wanted in patterns.items()
    }
    for motor, own in chosen.items():
        if not own:
            raise InputError("matches no run", f"sysid.motors.{motor}", f"the runs are {', '.join(runs)}")
    left = set(runs) - {run for own in chosen.values() for run in own}
    if left:
        raise InputError(f"no motor for run {min(left)!r}", "sysid.motors", "add a pattern that matches it")
    return chosen


def _samples(
    recording: Recording, runs: Sequence[str], columns: tuple[str, str], shapes: Mapping[str, Shape] = _NONE
) -> MotorSamples:
    """Return the samples of a voltage and a velocity, with loads that are shapes of the position."""
    wanted = (*columns, "position") if shapes else columns
    pieces = [segment.columns(wanted) for segment in segments(recording, runs)]
    pieces = [piece for piece in pieces if len(piece) > 2]
    if not pieces:
        raise InputError("no segment has three samples", recording.source or "recording", "record more")
    return MotorSamples(
        voltage=[piece[:, 0] for piece in pieces],
        velocity=[piece[:, 1] for piece in pieces],
        time_step=recording.time_step,
        speed_unit=recording.units[columns[1]],
        loads={name: [shape(piece[:, 2]) for piece in pieces] for name, shape in shapes.items()},
    )
