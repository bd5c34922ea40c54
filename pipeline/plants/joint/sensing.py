"""Sensors and logger of a joint."""

import numpy as np
import pandas as pd

from simgap.plants.joint.case import RECORDABLE, JointCase
from simgap.plants.joint.motion import SETTLING, STEP, Log
from simgap.plants.rotation import Array
from simgap.plants.sampling import at, held_at, instants, kept, quantised
from simgap.platforms import Joint


def record(
    log: Log, platform: Joint, case: JointCase, offset: float, names: tuple[str, ...], seed: list[int]
) -> pd.DataFrame:
    """Return the recording of all runs: `run`, `t` from 0, and the channels of the contract.

    Every channel of a run has a noise of its own, so that leaving one out changes no other.

    Args:
        log: the truth.
        platform: says whether the input is a voltage.
        case: sensors and logger.
        offset: by which position and velocity are late, s.
        names: of the runs.
        seed: of the noise.
    """
    samples = round(case.duration * case.rate)
    frames = []
    for run, name in enumerate(names):
        clock, *noise = (np.random.default_rng([*seed, run, part]) for part in range(7))
        times = instants(samples, case.rate, case.jitter, clock)
        channels = _motion(log, run, times - offset, case, noise[:2]) | _input(
            log, run, times, platform, case, noise[2]
        )
        for extra, random in zip(RECORDABLE, noise[3:], strict=True):
            if extra in case.channels and (platform.motor is not None or extra == "temperature"):
                truth = at(getattr(log, extra)[:, run], times, STEP, SETTLING)
                spread = case.sensors.scale * getattr(case.sensors, extra)
                channels[extra] = truth + spread * random.standard_normal(samples)
        frame = pd.DataFrame({"run": name, "t": times, **channels})
        frames.append(frame[kept(samples, case.dropped, clock)])
    return pd.concat(frames, ignore_index=True)


def _motion(
    log: Log, run: int, times: Array, case: JointCase, noise: list[np.random.Generator]
) -> dict[str, Array]:
    """Return position and velocity as the encoder, or a sensor of its own for the velocity, gives them."""
    sensors = case.sensors
    spread = sensors.scale * sensors.position

    def encoder(instant: Array) -> Array:
        truth = at(log.position[:, run], instant, STEP, SETTLING)
        noisy = truth + spread * noise[0].standard_normal(len(instant))
        return quantised(noisy, sensors.scale * sensors.position_step)

    position, window = encoder(times), sensors.velocity_window
    if window > 0:
        velocity = (encoder(times + 0.5 * window) - encoder(times - 0.5 * window)) / window
    else:
        truth = at(log.velocity[:, run], times, STEP, SETTLING)
        velocity = truth + sensors.scale * sensors.velocity * noise[1].standard_normal(len(times))
    return {"position": position, "velocity": velocity}


def _input(
    log: Log, run: int, times: Array, platform: Joint, case: JointCase, noise: np.random.Generator
) -> dict[str, Array]:
    """Return the command as it was given; where it is held, its controller logs it at its own tick."""
    ticks = np.arange(len(times)) / case.rate
    series = log.command[:, run]
    command = held_at(series, ticks, STEP, SETTLING) if case.held else at(series, times, STEP, SETTLING)
    if platform.motor is not None:
        return {"voltage": quantised(command, case.sensors.scale * case.sensors.voltage_step)}
    return {"effort": command + case.sensors.scale * case.sensors.effort * noise.standard_normal(len(times))}
