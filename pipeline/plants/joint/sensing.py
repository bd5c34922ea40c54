"""Sensors and logger of a joint."""

from typing import NamedTuple

import numpy as np
import pandas as pd
from scipy.signal import lfilter

from simgap.plants.joint.case import RECORDABLE, JointCase
from simgap.plants.joint.motion import SETTLING, STEP, Log
from simgap.plants.rotation import Array
from simgap.plants.sampling import at, held_at, instants, kept, quantised
from simgap.platforms import Joint


class SensorTiming(NamedTuple):
    """By how much position and velocity are recorded late, s.

    Attributes:
        offset: of both.
        filter: of the velocity beyond that.
    """

    offset: float
    filter: float


def record(
    log: Log,
    platform: Joint,
    case: JointCase,
    timing: SensorTiming,
    names: tuple[str, ...],
    seed: list[int],
) -> pd.DataFrame:
    """Return the recording of all runs: `run`, `t` from 0, and the channels of the contract.

    Every channel of a run has a noise of its own, so that leaving one out changes no other.

    Args:
        log: the truth.
        platform: says whether the input is a voltage.
        case: sensors and logger.
        timing: of position and velocity.
        names: of the runs.
        seed: of the noise.
    """
    samples = round(case.duration * case.rate)
    frames = []
    for run, name in enumerate(names):
        clock, *noise = (np.random.default_rng([*seed, run, part]) for part in range(7))
        times = instants(samples, case.rate, case.jitter, clock)
        motion = _motion(log, run, times - timing.offset, case, timing.filter, noise[:2])
        channels = {name: series for name, series in motion.items() if name not in case.without}
        channels |= _input(log, run, times, platform, case, noise[2])
        for extra, random in zip(RECORDABLE, noise[3:], strict=True):
            powered = platform.motor is not None and platform.controller is None
            if extra in case.channels and (powered or extra == "temperature"):
                truth = at(getattr(log, extra)[:, run], times, STEP, SETTLING)
                spread = case.sensors.scale * getattr(case.sensors, extra)
                channels[extra] = truth + spread * random.standard_normal(samples)
        frame = pd.DataFrame({"run": name, "t": times, **channels})
        frames.append(frame[kept(samples, case.dropped, clock)])
    return pd.concat(frames, ignore_index=True)


def filtered(series: Array, delay: float) -> Array:
    """Return what a drive reports of a series (steps, ...): a moving mean, and a first-order filter after it.

    The two halve the delay among them, as in a drive that counts encoder pulses over a window and smooths the counts.

    Args:
        series: one sample every `STEP`.
        delay: of slow motion, s; 0 leaves the series as it is.
    """
    if not delay:
        return series
    window, kept = max(round(delay / STEP), 1), np.exp(-STEP / (0.5 * delay))
    counted = lfilter(np.full(window, 1.0 / window), [1.0], series - series[:1], axis=0)
    return series[:1] + lfilter([1.0 - kept], [1.0, -kept], counted, axis=0)


def _motion(
    log: Log, run: int, times: Array, case: JointCase, delay: float, noise: list[np.random.Generator]
) -> dict[str, Array]:
    """Return position and velocity as the encoder, or a sensor of its own for the velocity, gives them."""
    sensors = case.sensors
    spread = sensors.scale * sensors.position

    def encoder(instant: Array, series: Array = log.position[:, run]) -> Array:
        truth = at(series, instant, STEP, SETTLING)
        noisy = truth + spread * noise[0].standard_normal(len(instant))
        return quantised(noisy, sensors.scale * sensors.position_step)

    position, window = encoder(times), sensors.velocity_window
    if window > 0:
        late = filtered(log.position[:, run], delay)
        velocity = (encoder(times + 0.5 * window, late) - encoder(times - 0.5 * window, late)) / window
    else:
        truth = at(filtered(log.velocity[:, run], delay), times, STEP, SETTLING)
        velocity = truth + sensors.scale * sensors.velocity * noise[1].standard_normal(len(times))
    return {"position": position, "velocity": velocity}


def _input(
    log: Log, run: int, times: Array, platform: Joint, case: JointCase, noise: np.random.Generator
) -> dict[str, Array]:
    """Return the command as it was given; where it is held, its controller logs it at its own tick."""
    ticks = np.arange(len(times)) / case.rate
    series = log.command[:, run]
    command = held_at(series, ticks, STEP, SETTLING) if case.held else at(series, times, STEP, SETTLING)
    if platform.controller is not None:
        return {"position_command": command}
    if platform.motor is not None:
        return {"voltage": quantised(command, case.sensors.scale * case.sensors.voltage_step)}
    return {"effort": command + case.sensors.scale * case.sensors.effort * noise.standard_normal(len(times))}
