"""The reward of a control step (Kaufmann et al. 2023, Nature 620, Methods, eqs. of the reward)."""

import math
from dataclasses import replace

import torch
from torch import Tensor

from simgap.physics import rotations
from simgap.policies.racing.settings import Reward


def racing_reward(
    settings: Reward,
    before: Tensor,
    after: dict[str, Tensor],
    gate: Tensor,
    command: Tensor,
    previous: Tensor,
    crashed: Tensor,
    crash: Tensor,
) -> Tensor:
    """Return r_prog + r_perc + r_cmd − r_crash, (batch,).

    Args:
        settings: the weights of all but crashes.
        before: position at the start of the step, (batch, 3) m.
        after: state at its end, each part (batch, ...).
        gate: middle of the gate that was to be passed, (batch, 3) m.
        command: collective thrust over mass and body rates, (batch, 4) m/s² and rad/s.
        previous: command of the step before, (batch, 4).
        crashed: (batch,) bool.
        crash: what it costs now, a tensor without dimensions: a captured step reads it anew, and a number only once.
    """
    towards = gate - after["position"]
    distance = torch.linalg.vector_norm(towards, dim=-1)
    progress = torch.linalg.vector_norm(gate - before, dim=-1) - distance
    angle = viewing_angle(settings, after["attitude"], towards)
    rates = torch.linalg.vector_norm(command[:, 1:], dim=-1)
    change = (command - previous).square().sum(-1)
    return (
        settings.progress * progress
        + settings.perception * torch.exp(settings.perception_angle * angle**4)
        + settings.rates * rates
        + settings.change * change
        - crash * crashed
    )


def reward_at(settings: Reward, share: float) -> Reward:
    """Return the weights when a share of the training, 0 to 1, is done.

    A high crash cost from the beginning leads to slow policies that become faster only much later.
    """
    if settings.first_crash is None:
        return settings
    return replace(settings, crash=(1.0 - share) * settings.first_crash + share * settings.crash)


def viewing_angle(settings: Reward, attitude: Tensor, towards: Tensor) -> Tensor:
    """Return the angle δ_cam between the camera's axis and the way to the gate, (batch,) rad.

    Args:
        settings: how far the camera looks up.
        attitude: unit quaternions, (batch, 4).
        towards: from machine to gate, world frame, (batch, 3) m.
    """
    pitch = settings.camera_pitch
    one = torch.ones_like(towards[:, 0])
    camera = torch.stack([math.cos(pitch) * one, 0.0 * one, math.sin(pitch) * one], dim=-1)
    axis = rotations.rotate(attitude, camera)
    across = torch.linalg.vector_norm(rotations.cross(axis, towards), dim=-1)
    return torch.atan2(across, (axis * towards).sum(-1))
