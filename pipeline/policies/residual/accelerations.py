"""The acceleration that a simulator leaves over along recorded flights."""

import pandas as pd
import torch
from torch import Tensor

from simgap.errors import InputError
from simgap.physics.weak_form import moving_mean_of, moving_mean_rate_of, moving_window
from simgap.platforms import Quadrotor
from simgap.recordings.excerpt import evenly
from simgap.recordings.recording import Recording
from simgap.simulation import Simulator
from simgap.simulation.knn_residual import (
    NearestNeighbours,
    RecordedResidual,
    commanded_thrust,
    residual_features,
)
from simgap.simulation.signals import recorded_signals

_AXES = "xyz"


def left_over(simulator: Simulator, recording: Recording, width: float) -> tuple[Tensor, Tensor]:
    """Return what the residual is looked up by, (windows, 7), and the specific force left over, (windows, 3) m/s².

    Where motor commands were recorded the simulator is driven by them, as a policy drives it, and measured rotor speeds
    are left aside.

    Args:
        simulator: of a quadrotor.
        recording: cleaned.
        width: of the windows over which an acceleration is a mean, s.

    Raises:
        InputError: when the simulator is not of a quadrotor, or no stretch of the recording is as long as a window.
    """
    platform = simulator.platform
    if not isinstance(platform, Quadrotor):
        raise InputError(f"a {platform.kind} has no such residual", "platform", "choose a quadrotor")
    parts = [
        _of_stretch(simulator, stretch, recording.time_step, width)
        for _, stretch in recording.frame.groupby(["run", "segment"], sort=False)
    ]
    features, residual = (torch.cat(part) for part in zip(*parts, strict=True))
    if not len(features):
        raise InputError("is too short", recording.source or "recording", "record longer flights")
    return features, residual


def _of_stretch(
    simulator: Simulator, stretch: pd.DataFrame, time_step: float, width: float
) -> tuple[Tensor, Tensor]:
    window = moving_window(width, time_step)
    signals = recorded_signals(stretch, simulator.platform)
    if "motor_command" in signals:
        signals = {name: series for name, series in signals.items() if name != "rotor_speed"}
    acting = simulator.along_time({name: series[None] for name, series in signals.items()}, time_step)
    balance = simulator.balance(acting)
    residual = [
        moving_mean_rate_of(window, balance.momentum[channel]) - moving_mean_of(window, balance.rate[channel])
        for channel in (f"force_{axis}" for axis in _AXES)
    ]
    thrust = commanded_thrust(acting, simulator.platform)[..., None]  # type: ignore[arg-type]
    looked_up = residual_features(acting["velocity"], acting["body_rate"], thrust)
    features = [moving_mean_of(window, column) for column in looked_up.unbind(-1)]
    return torch.stack(features, -1)[0], torch.stack(residual, -1)[0]


def nearest_of(
    features: Tensor, residual: Tensor, samples: int, count: int, platform: Quadrotor
) -> RecordedResidual:
    """Return the residual as a part of a simulator, looked up among samples evenly over the recording.

    Args:
        features: of `left_over`, (windows, 7).
        residual: of `left_over`, (windows, 3) m/s².
        samples: at most.
        count: of neighbours.
        platform: which the residual belongs to.
    """
    chosen = evenly(len(features), samples)
    neighbours = NearestNeighbours(features[chosen].float(), residual[chosen].float(), count)
    return RecordedResidual(neighbours, platform)
