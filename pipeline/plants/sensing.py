"""Sensors and logger of a quadrotor."""

import numpy as np
import pandas as pd

from simgap.plants.battery import Battery, voltage_behind
from simgap.plants.case import PlantCase
from simgap.plants.estimator import believed, errors_along
from simgap.plants.flight import Log
from simgap.plants.rotation import Array, from_small_angles, product
from simgap.plants.sampling import at, instants, kept, quantised
from simgap.platforms import Quadrotor

_COMMAND_STEP = 1.0 / 2000.0  # DShot has two thousand levels


def record(
    log: Log,
    platform: Quadrotor,
    case: PlantCase,
    names: tuple[str, ...],
    charge: Array,
    random: np.random.Generator,
) -> pd.DataFrame:
    """Return the recording of all runs: `run`, `t` from 0, and the channels of the contract.

    Args:
        log: what truly happened.
        platform: sizes the pack and scales the commands.
        case: how it is recorded.
        names: of the runs.
        charge: of the packs at the start, (runs,).
        random: of the sensors.
    """
    samples = round(case.duration * case.rate)
    draw = _Noise(case, random)
    voltage = _voltage(log, platform, case, charge, samples)
    errors = errors_along(log, case, random.spawn(1)[0]) if case.estimates > 0 else None
    frames = []
    for run, name in enumerate(names):
        t = instants(samples, case.rate, case.jitter, random)
        frame = _run(log, run, t, platform, case, draw)
        frame["battery_voltage"] = draw(voltage[:, run], "battery_voltage")
        if errors is not None:
            frame = frame.assign(**believed(log, run, t, errors))
        frame.insert(0, "run", name)
        frames.append(frame[kept(samples, case.dropped, random)])
    recorded = pd.concat(frames, ignore_index=True)
    return recorded[[column for column in recorded if not str(column).startswith(tuple(case.hidden))]]


def _voltage(log: Log, platform: Quadrotor, case: PlantCase, charge: Array, samples: int) -> Array:
    """Return the battery's voltage (samples, runs), V: as it was, or as the flight left it."""
    grid = np.arange(samples) / case.rate
    if log.voltage is not None:
        return at(log.voltage, grid, log.step, log.before)
    speed = at(log.rotor_speed, grid, log.step, log.before)
    return voltage_behind(Battery(platform, charge, case.battery_wear), speed, 1.0 / case.rate)


class _Noise:
    """White noise and quantisation by the names of `Sensors`."""

    def __init__(self, case: PlantCase, random: np.random.Generator) -> None:
        self.sensors, self.random = case.sensors, random

    def __call__(self, values: Array, sensor: str) -> Array:
        spread = self.sensors.scale * getattr(self.sensors, sensor)
        step = self.sensors.scale * getattr(self.sensors, f"{sensor}_step", 0.0)
        noisy = values + spread * self.random.standard_normal(values.shape)
        return quantised(noisy, step)

    def turn(self, attitude: Array) -> Array:
        """Return attitudes (samples, 4) turned by a little about each body axis."""
        spread = self.sensors.scale * self.sensors.attitude
        noisy = product(attitude, from_small_angles(spread * self.random.standard_normal((len(attitude), 3))))
        noisy /= np.linalg.norm(noisy, axis=-1, keepdims=True)
        return np.where(noisy[:, :1] < 0, -noisy, noisy)


def _run(log: Log, run: int, t: Array, platform: Quadrotor, case: PlantCase, draw: _Noise) -> pd.DataFrame:
    late = t - case.strength("sensor_time_offset")
    state = {
        name: at(getattr(log, name)[:, run], late, log.step, log.before)
        for name in ("position", "velocity", "attitude", "body_rate", "specific_force")
    }
    speed = at(log.rotor_speed[:, run], t, log.step, log.before)
    command = at(log.rotor_command[:, run], t, log.step, log.before) / platform.motor_speed_max
    channels = {
        ("position", "xyz"): draw(state["position"], "position"),
        ("attitude", "wxyz"): draw.turn(state["attitude"]),
        ("velocity", "xyz"): draw(state["velocity"], "velocity"),
        ("body_rate", "xyz"): draw(state["body_rate"], "body_rate"),
        ("motor_speed", "1234"): np.maximum(draw(speed, "motor_speed"), 0.0),
        ("motor_command", "1234"): np.clip(quantised(command, case.sensors.scale * _COMMAND_STEP), 0.0, 1.0),
        ("specific_force", "xyz"): draw(state["specific_force"], "specific_force"),
    }
    columns = {
        f"{name}_{axis}": values[:, index]
        for (name, axes), values in channels.items()
        for index, axis in enumerate(axes)
    }
    return pd.DataFrame({"t": t, **columns})
