"""Sensors and logger of a swerve drive."""

import numpy as np
import pandas as pd

from simgap.plants.rotation import Array
from simgap.plants.sampling import at, held_at, instants, kept, quantised
from simgap.plants.swerve.case import SwerveCase
from simgap.plants.swerve.motion import SETTLING, STEP, Log

_COMMANDED = ("drive_voltage", "steer_voltage")
_DELAYED = ("drive_velocity", "steer_velocity", "steer_angle", "twist")


def record(
    log: Log, case: SwerveCase, offset: float, names: tuple[str, ...], seed: list[int]
) -> pd.DataFrame:
    """Return the recording of all runs: `run`, `t` from 0, and the channels of the contract.

    Every channel of a run has a noise of its own, so that leaving one out changes no other.

    Args:
        log: the truth.
        case: sensors and logger.
        offset: by which the motion is late with respect to the voltages, s.
        names: of the runs.
        seed: of the noise.
    """
    samples = round(case.duration * case.rate)
    frames = []
    for run, name in enumerate(names):
        clock, noise, extra = (np.random.default_rng([*seed, run, part]) for part in range(3))
        times = instants(samples, case.rate, case.jitter, clock)
        truth = {
            key: at(getattr(log, key)[:, run], times - (offset if key in _DELAYED else 0.0), STEP, SETTLING)
            for key in Log.__dataclass_fields__
        }
        if case.held:  # its controllers log a command at their own tick
            ticks = np.arange(samples) / case.rate
            truth |= {key: held_at(getattr(log, key)[:, run], ticks, STEP, SETTLING) for key in _COMMANDED}
        frame = pd.DataFrame(
            {"run": name, "t": times, **_modules(truth, case, noise), **_extra(truth, case, extra)}
        )
        frames.append(frame[kept(samples, case.dropped, clock)])
    return pd.concat(frames, ignore_index=True)


def _modules(truth: dict[str, Array], case: SwerveCase, noise: np.random.Generator) -> dict[str, Array]:
    """Return voltages and motion of the modules."""
    sensors, scale = case.sensors, case.sensors.scale
    channels = {
        name: quantised(truth[name], scale * sensors.voltage_step)
        for name in ("drive_voltage", "steer_voltage")
    }
    for name in ("drive_velocity", "steer_velocity", "steer_angle"):
        channels[name] = truth[name] + scale * getattr(sensors, name) * noise.standard_normal(
            truth[name].shape
        )
    channels["steer_angle"] = quantised(channels["steer_angle"], scale * sensors.steer_angle_step)
    return _numbered(channels)


def _extra(truth: dict[str, Array], case: SwerveCase, noise: np.random.Generator) -> dict[str, Array]:
    """Return what is recorded besides the motors."""
    sensors, scale = case.sensors, case.sensors.scale
    spread = scale * np.array([sensors.chassis_velocity, sensors.chassis_velocity, sensors.chassis_rate])
    twist = truth["twist"] + spread * noise.standard_normal(truth["twist"].shape)
    battery = truth["battery_voltage"]
    battery = battery + scale * sensors.battery_voltage * noise.standard_normal(battery.shape)
    currents = {
        name: truth[name] + scale * sensors.current * noise.standard_normal(truth[name].shape)
        for name in ("drive_current", "steer_current")
    }
    names = ("chassis_velocity_x", "chassis_velocity_y", "chassis_rate")
    offered = {
        "chassis": dict(zip(names, twist.T, strict=True)),
        "battery_voltage": {"battery_voltage": battery},
        "current": _numbered(currents),
    }
    return {name: series for key in offered if key in case.channels for name, series in offered[key].items()}


def _numbered(channels: dict[str, Array]) -> dict[str, Array]:
    return {
        f"{name}_{module + 1}": series[:, module] for name, series in channels.items() for module in range(4)
    }
