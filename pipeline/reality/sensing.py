"""From what happened to what was recorded."""

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from pipeline.platforms import Quadrotor
from pipeline.reality.battery import terminal_voltage
from pipeline.reality.case import PlantCase
from pipeline.reality.flight import SETTLING, Log
from pipeline.reality.rotation import Array, from_small_angles, product

_COMMAND_STEP = 1.0 / 2000.0  # DShot has two thousand levels


def record(
    log: Log, platform: Quadrotor, case: PlantCase, names: tuple[str, ...], random: np.random.Generator
) -> pd.DataFrame:
    """Return the recording of all runs: `run`, `t` from 0, and the channels of the contract."""
    samples = round(case.duration * case.rate)
    grid = np.arange(samples) / case.rate
    draw = _Noise(case, random)
    voltage = terminal_voltage(platform, _at(log.rotor_speed, grid, log.step), 1.0 / case.rate, random)
    frames = []
    for run, name in enumerate(names):
        t = grid + case.jitter * np.clip(random.standard_normal(samples), -2.5, 2.5) * (grid > 0)
        frame = _run(log, run, t, platform, case, draw)
        frame["battery_voltage"] = draw(voltage[:, run], "battery_voltage")
        frame.insert(0, "run", name)
        frames.append(frame[_kept(samples, case, random)])
    return pd.concat(frames, ignore_index=True)


class _Noise:
    """White noise and quantisation by the names of `Sensors`."""

    def __init__(self, case: PlantCase, random: np.random.Generator) -> None:
        self.sensors, self.random = case.sensors, random

    def __call__(self, values: Array, sensor: str) -> Array:
        spread = self.sensors.scale * getattr(self.sensors, sensor)
        step = self.sensors.scale * getattr(self.sensors, f"{sensor}_step", 0.0)
        noisy = values + spread * self.random.standard_normal(values.shape)
        return _quantised(noisy, step)

    def turn(self, attitude: Array) -> Array:
        """Return attitudes (samples, 4) turned by a little about each body axis."""
        spread = self.sensors.scale * self.sensors.attitude
        noisy = product(attitude, from_small_angles(spread * self.random.standard_normal((len(attitude), 3))))
        noisy /= np.linalg.norm(noisy, axis=-1, keepdims=True)
        return np.where(noisy[:, :1] < 0, -noisy, noisy)


def _run(log: Log, run: int, t: Array, platform: Quadrotor, case: PlantCase, draw: _Noise) -> pd.DataFrame:
    late = t - case.strength("sensor_time_offset")
    state = {
        name: _at(getattr(log, name)[:, run], late, log.step)
        for name in ("position", "velocity", "attitude", "body_rate", "specific_force")
    }
    speed = _at(log.rotor_speed[:, run], t, log.step)
    command = _at(log.rotor_command[:, run], t, log.step) / platform.motor_speed_max
    channels = {
        ("position", "xyz"): draw(state["position"], "position"),
        ("attitude", "wxyz"): draw.turn(state["attitude"]),
        ("velocity", "xyz"): draw(state["velocity"], "velocity"),
        ("body_rate", "xyz"): draw(state["body_rate"], "body_rate"),
        ("motor_speed", "1234"): np.maximum(draw(speed, "motor_speed"), 0.0),
        ("motor_command", "1234"): np.clip(_quantised(command, case.sensors.scale * _COMMAND_STEP), 0.0, 1.0),
        ("specific_force", "xyz"): draw(state["specific_force"], "specific_force"),
    }
    columns = {
        f"{name}_{axis}": values[:, index]
        for (name, axes), values in channels.items()
        for index, axis in enumerate(axes)
    }
    return pd.DataFrame({"t": t, **columns})


def _at(series: Array, times: Array, step: float) -> Array:
    """Interpolate a log (steps, ...) at times, s; beyond its end the last value is held."""
    place = np.clip((times + SETTLING) / step, 0.0, len(series) - 1.0)
    below = np.minimum(np.floor(place + 1e-9).astype(int), len(series) - 2)
    share = np.maximum(place - below, 0.0).reshape(-1, *[1] * (series.ndim - 1))
    return series[below] * (1.0 - share) + series[below + 1] * share


def _quantised(values: Array, step: float) -> Array:
    return np.round(values / step) * step if step > 0 else values


def _kept(samples: int, case: PlantCase, random: np.random.Generator) -> NDArray[np.bool_]:
    """Mark the samples that are not lost; the first and the last never are."""
    kept = random.random(samples) >= case.dropped
    kept[[0, -1]] = True
    return kept
