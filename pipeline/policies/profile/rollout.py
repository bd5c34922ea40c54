"""Rollout of a trained policy."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import torch
from torch import Tensor

from simgap.policies.profile.drive import Drive
from simgap.policies.profile.driven import Driven
from simgap.policies.profile.environment import MotionProfile
from simgap.policies.profile.motion import Motion, drive_along
from simgap.policies.profile.settings import Profile

_REST = 0.1  # s that the drive is watched after the policy has arrived


@torch.no_grad()
def drive_by_policy(
    policy: Callable[[Tensor], Tensor], task: Profile, drive: Drive, driven: Driven | None = None
) -> Motion:
    """Return the motion from rest until the policy arrives, or its time is over, and a moment of standing.

    Args:
        policy: from an observation (1, observation_size) to an action (1, 1) within ±1.
        task: the way.
        drive: identified.
        driven: what moves; None: the identified drive itself.
    """
    environment = MotionProfile(replace(task, on_the_way=0.0), drive, 1, drive.speed.device, driven)
    observation = environment.start(0)
    desired: list[float] = []
    for _ in range(environment.episode_steps):
        action = policy(observation.policy)
        desired.append(task.speed_limit * float(action.clamp(-1.0, 1.0)))
        transition = environment.step(action)
        if bool(transition.terminated):
            break
        observation = transition.observation
    rest = np.zeros(round(_REST / task.period))
    return drive_along(drive, np.concatenate([desired, rest]), task.period, driven)
