"""Smoothing of voltages by a moving average."""

import torch
from torch import Tensor

from simgap.policies.profile.drive import Drive
from simgap.policies.profile.motion import Motion


def smoothed(drive: Drive, motion: Motion, window: int) -> Tensor:
    """Return the voltages of a forward motion as a moving average, (steps + window - 1, wheels) V.

    The friction voltage is excluded from the average and added again over the longer motion. From rest to rest
    ∫(V − kS) dt = kV·y, so the distance does not change.

    Args:
        drive: identified, whose friction is known.
        motion: forward, from rest to rest.
        window: steps that are averaged; 1 leaves the voltages alone.

    Returns:
        Voltages that end `window` - 1 steps later.
    """
    moving = torch.from_numpy((motion.velocity[:-1] > 0.0) | (motion.velocity[1:] > 0.0))
    voltage = torch.from_numpy(motion.voltage).to(drive.static)
    beyond = torch.where(moving[:, None], voltage - drive.static, torch.zeros_like(voltage))
    last = int(moving.nonzero().max()) + window if bool(moving.any()) else 0
    still = beyond.new_zeros(window - 1, beyond.shape[1])
    average = torch.cat([still, beyond, still]).unfold(0, window, 1).mean(-1)
    average[:last] += drive.static
    return average
