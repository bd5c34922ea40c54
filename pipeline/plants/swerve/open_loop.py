"""Open-loop trials of a concealed swerve drive straight ahead, with planned voltages."""

import math
from dataclasses import dataclass, replace

import numpy as np

from simgap.errors import InputError
from simgap.plants.concealment import Chosen, Concealed, Table, components
from simgap.plants.rotation import Array
from simgap.plants.swerve.case import SwerveCase
from simgap.plants.swerve.controller import ModuleController
from simgap.plants.swerve.motion import SETTLING, STEP, move
from simgap.plants.swerve.reference import Reference
from simgap.platforms import Swerve

_WATCHED_AFTER = 0.5  # s that the robot is watched after the last voltage


@dataclass(frozen=True)
class Trial:
    """True motion of one trial.

    Attributes:
        time: from the first voltage on, (samples,) s.
        position: along the direction in which the robot stood at the start, (samples,) m.
        aside: to the left of it, (samples,) m.
        velocity: along the robot's own forward axis, (samples,) m/s.
    """

    time: Array
    position: Array
    aside: Array
    velocity: Array


def drive_trials(
    case: SwerveCase, platform: Swerve, voltage: Array, period: float, trials: int, scatter: float, seed: int
) -> list[Trial]:
    """Drive the same voltages several times; between two trials whatever the robot conceals is a little different.

    Args:
        case: of the robot, as it was recorded; of its drives only the sensors and the steering loops count.
        platform: what its controllers believe.
        voltage: by module, each row held for a period, (steps, 4) V.
        period: s, a whole number of milliseconds.
        trials: how many.
        scatter: standard deviation of the strength of each concealed effect, as a share of it.
        seed: of every random draw.

    Raises:
        InputError: when the case cannot be driven, or the period does not fit.
    """
    case.check()
    held = round(period / STEP)
    if held < 1 or not math.isclose(held * STEP, period, rel_tol=1e-6) or round(SETTLING / STEP) % held:
        remedy = "give one that goes into 0.8 s in whole milliseconds"
        raise InputError(f"a voltage cannot be held for {period:g} s", "period", remedy)
    draws = (np.random.default_rng([seed, trial]) for trial in range(trials))
    return [_drive(case, platform, voltage, period, scatter, random) for random in draws]


def _drive(
    case: SwerveCase,
    platform: Swerve,
    voltage: Array,
    period: float,
    scatter: float,
    random: np.random.Generator,
) -> Trial:
    effects, outside = case.concealed(platform)
    effects, outside = (_scattered(entry, scatter, random) for entry in (effects, outside))
    told = replace(case, runs=1, rate=1.0 / period, held=True)
    begun = round(SETTLING / STEP)
    steps = begun + round((len(voltage) * period + _WATCHED_AFTER) / STEP) + 1
    still = np.zeros((steps, 1, 4))
    reference = Reference(still, still, still, still, still)
    controller = _Told(platform, told, reference, voltage, begun, round(period / STEP))
    log = move(effects, outside, platform, told, reference, random, controller)
    return _trial(log.twist[begun:, 0])


class _Told(ModuleController):
    """Keeps the modules straight, and passes on what it was told to drive with."""

    def __init__(
        self, platform: Swerve, case: SwerveCase, reference: Reference, voltage: Array, begun: int, held: int
    ) -> None:
        super().__init__(platform, case, reference)
        self.voltage, self.begun, self.every = voltage, begun, held

    def drive(self, count: int, motor_speed: Array) -> Array:
        """Return the drive voltages (1, 4), V, of a step; 0 before the first and after the last."""
        row = (count - self.begun) // self.every
        most = self.platform.drive.motor.nominal_voltage
        told = self.voltage[row] if 0 <= row < len(self.voltage) else np.zeros(4)
        return np.clip(told, -most, most)[None]


def _trial(twist: Array) -> Trial:
    """Follow the robot through its twists (samples, 3)."""
    heading = _summed(twist[:, 2])
    cosine, sine = np.cos(heading), np.sin(heading)
    along, aside = twist[:, 0] * cosine - twist[:, 1] * sine, twist[:, 0] * sine + twist[:, 1] * cosine
    return Trial(STEP * np.arange(len(twist), dtype=np.float64), _summed(along), _summed(aside), twist[:, 0])


def _summed(rate: Array) -> Array:
    total: Array = np.concatenate([[0.0], np.cumsum(0.5 * STEP * (rate[1:] + rate[:-1]))])
    return total


def _scattered(concealed: Concealed, scatter: float, random: np.random.Generator) -> Concealed:
    """Return the same effects, each a little stronger or weaker."""
    table: Table = concealed.table
    chosen: Chosen = {
        name: {
            key: table[name][key].scaled(value, factor) if key in components(table[name]) else value
            for key, value in values.items()
        }
        for name, values in concealed.values.items()
        for factor in [1.0 + scatter * random.standard_normal()]
    }
    return Concealed(chosen, table, {})
