"""A recording of commanded and true body rates whose transfer functions are known."""

import numpy as np
import pandas as pd

from simgap.models.second_order import SecondOrder, responses
from simgap.recordings.recording import Recording
from tests.pipeline.models.synthetic import recording

COMMANDED = (
    SecondOrder(gain=0.9, time_constant=0.08, damping=0.6),
    SecondOrder(gain=0.8, time_constant=0.06, damping=0.7),
    SecondOrder(gain=1.0, time_constant=0.12, damping=0.9),
)
STEP = 0.02


def rig(samples: int = 250) -> Recording:
    """Return four runs of a machine that stays where it is, level, and turns as it is commanded."""
    frames = []
    for seed, run in enumerate(("a", "b", "c", "d")):
        random = np.random.default_rng(seed)
        data = {"position_x": 0.0, "position_y": 0.0, "position_z": 1.0}
        data |= {"attitude_w": 1.0, "attitude_x": 0.0, "attitude_y": 0.0, "attitude_z": 0.0}
        data |= {f"velocity_{axis}": 0.0 for axis in "xyz"}
        rates = {}
        for axis, system in zip("xyz", COMMANDED, strict=True):
            command = np.repeat(random.uniform(-3, 3, samples // 5), 5)
            _, forced = responses(system, STEP, samples)
            rates |= {f"body_rate_{axis}": (forced @ command)[:-1], f"body_rate_command_{axis}": command}
        commands = {f"motor_command_{number}": 0.5 for number in range(1, 5)}
        time = STEP * np.arange(samples)
        frames.append(pd.DataFrame({"run": run, "t": time, "segment": 0} | data | rates | commands))
    parts = {"a": "train", "b": "train", "c": "validation", "d": "holdout"}
    return recording(pd.concat(frames, ignore_index=True), "quadrotor", parts)
