"""Recordings that a simulator made of itself."""

import numpy as np
import pandas as pd
import torch
from torch import Tensor

from simgap.recordings.contract import channel_units
from simgap.recordings.recording import Recording
from simgap.simulation import Simulator, rollout
from simgap.simulation.motion import motion_of

_SUFFIXES = {3: ("x", "y", "z"), 4: ("1", "2", "3", "4")}


def smooth(shape: tuple[int, ...], time_step: float, seed: int) -> Tensor:
    """Return sums of slow sines with random phases between −1 and 1, time in the second dimension."""
    random = torch.Generator().manual_seed(seed)
    time = torch.arange(shape[1], dtype=torch.float64) * time_step
    total = torch.zeros(shape, dtype=torch.float64)
    for frequency in (0.4, 1.1, 2.3):
        phase = 6.3 * torch.rand((shape[0], 1, *shape[2:]), generator=random, dtype=torch.float64)
        total += torch.sin(6.283 * frequency * time.reshape(1, -1, *[1] * len(shape[2:])) + phase) / 3.0
    return total


def columns(kind: str, name: str, series: Tensor) -> dict[str, np.ndarray]:
    """Return the columns of the contract that hold a signal (samples, ...)."""
    name = "motor_speed" if name == "rotor_speed" else name
    values = series.numpy()
    if name == "chassis_velocity":
        return {
            "chassis_velocity_x": values[:, 0],
            "chassis_velocity_y": values[:, 1],
            "chassis_rate": values[:, 2],
        }
    if series.ndim == 1:
        return {name: values}
    suffixes = ("w", "x", "y", "z") if name == "attitude" else _SUFFIXES[series.shape[1]]
    return {f"{name}_{suffix}": values[:, index] for index, suffix in enumerate(suffixes)}


def recorded(
    simulator: Simulator, initial: Tensor, commands: dict[str, Tensor], time_step: float, substeps: int = 1
) -> Recording:
    """Return what a simulator does, one run for each entry of the batch; each command is held until the next."""
    kind = simulator.platform.kind
    states = rollout(simulator, initial, commands, time_step, substeps)[:, :-1]
    motion = motion_of(simulator.platform)
    signals = motion.signals(states, simulator.constants())
    signals |= {
        name: states[..., where] for name, where in motion.parts.items()
    }  # velocity in the world frame
    signals.pop("heading", None)  # follows from the chassis' rate
    if kind == "joint":
        signals = {"position": states[..., 0], "velocity": states[..., 1]}
    frames = []
    for run in range(len(initial)):
        channels: dict[str, np.ndarray] = {}
        for name, series in (signals | commands).items():
            channels |= columns(kind, name, series[run])
        time = np.arange(states.shape[1]) * time_step
        frames.append(pd.DataFrame({"run": f"run{run}", "t": time, "segment": 0} | channels))
    frame = pd.concat(frames, ignore_index=True)
    units = {name: unit for name, unit in channel_units(kind).items() if name in frame}
    return Recording(frame, kind, units, cleaned=True)
