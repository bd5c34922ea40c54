"""Small recordings from which models learn within a second, and small settings for every model."""

from dataclasses import replace

import numpy as np
import pandas as pd

from simgap.models.layouts import layout_of
from simgap.models.registry import MODELS, model_settings
from simgap.models.settings import Training
from simgap.models.windows import Series, series_of
from simgap.recordings.recording import Recording
from tests.pipeline.models.synthetic import flight, recording

SMALL = {
    "linear": {"sequence_length": 2},
    "state_space": {},
    "fnn": {"sequence_length": 2, "hidden": [16], "learning_rate": 0.01, "dropout": [0.1]},
    "lstm": {"sequence_length": 4, "hidden": [8], "learning_rate": 0.01},
    "tcn": {"sequence_length": 4, "hidden": [8, 8], "dropout": [], "learning_rate": 0.01},
    "white_box": {},
    "black_box": {"sequence_length": 4, "units": 8, "layers": 2, "delays": 2, "learning_rate": 0.01},
    "hybrid_parallel": {"sequence_length": 4, "units": 8, "layers": 1, "learning_rate": 0.01},
    "hybrid_serial": {"sequence_length": 4, "units": 8, "layers": 2, "learning_rate": 0.01},
    "transfer_function": {"sequence_length": 4, "simulated": 20},
    "narx": {"sequence_length": 2, "hidden": 4},
    "rbf": {"sequence_length": 2, "candidates": 50, "neurons": 20},
}
NOT_FOR = {"transfer_function": {"quadrotor"}}  # kinds that a model refuses
QUICK = Training(max_epochs=4, batch_size=128)
PARTS = {"a": "train", "b": "train", "c": "validation", "d": "holdout"}


def linear_joint(samples: int = 300) -> Recording:
    """Return four runs of a sliding mass on a spring with a damper, linear in every sample."""
    frames = []
    for seed, run in enumerate(PARTS):
        rng = np.random.default_rng(seed)
        effort = np.repeat(rng.normal(size=samples // 10), 10)
        position, velocity = np.zeros(samples), np.zeros(samples)
        for k in range(samples - 1):
            velocity[k + 1] = velocity[k] + 0.02 * (effort[k] - 0.8 * velocity[k] - 3.0 * position[k])
            position[k + 1] = position[k] + 0.01 * (velocity[k] + velocity[k + 1])
        time = 0.02 * np.arange(samples)
        frames.append(
            pd.DataFrame(
                {
                    "run": run,
                    "t": time,
                    "segment": 0,
                    "position": position,
                    "velocity": velocity,
                    "effort": effort,
                }
            )
        )
    return recording(pd.concat(frames, ignore_index=True), "joint", PARTS, sliding=True)


def swerve(samples: int = 200) -> Recording:
    """Return four runs of four modules that follow their voltages with a lag, and of a chassis that follows them."""
    frames = []
    for seed, run in enumerate(PARTS):
        rng = np.random.default_rng(seed)
        data: dict[str, np.ndarray] = {}
        for number in range(1, 5):
            for group in ("drive", "steer"):
                voltage = np.repeat(rng.normal(size=samples // 10), 10)
                speed = np.zeros(samples)
                for k in range(samples - 1):
                    speed[k + 1] = 0.9 * speed[k] + 0.3 * voltage[k]
                data |= {f"{group}_voltage_{number}": voltage, f"{group}_velocity_{number}": speed}
            data[f"steer_angle_{number}"] = np.cumsum(data[f"steer_velocity_{number}"]) * 0.02
        for number, name in enumerate(("velocity_x", "velocity_y", "rate"), start=1):
            data[f"chassis_{name}"] = 0.1 * (data["drive_velocity_4"] + data[f"drive_velocity_{number}"])
        time = 0.02 * np.arange(samples)
        frames.append(pd.DataFrame({"run": run, "t": time, "segment": 0} | data))
    return recording(pd.concat(frames, ignore_index=True), "swerve", PARTS)


def quadrotor() -> Recording:
    """Return four short flights."""
    frames = [flight(run, seed, duration=2.0) for seed, run in enumerate(PARTS)]
    return recording(pd.concat(frames, ignore_index=True), "quadrotor", PARTS)


def parts_of(recorded: Recording, layout_name: str | None = None) -> tuple[Series, Series, Series]:
    """Return training, validation and held-out series."""
    layout = layout_of(recorded, layout_name)
    train, validation, held = (
        series_of(recorded, layout, [run for run in recorded.runs if PARTS[run] == part])
        for part in ("train", "validation", "holdout")
    )
    return train, validation, held


def new_model(name: str, recorded: Recording, layout: str | None = None, **options):
    """Return an untrained small model."""
    settings = model_settings({"name": name} | SMALL[name] | options)
    return MODELS[name](layout_of(recorded, layout), replace(settings), recorded.time_step)
