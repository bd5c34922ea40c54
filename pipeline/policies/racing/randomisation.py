"""Domain randomisation: random forces and torques for every episode.

Tobin et al. 2017, "Domain randomization for transferring deep neural networks", arXiv 1703.06907.
"""

import torch
from torch import Tensor

from simgap.policies.racing.settings import Randomisation

DRAWN = 7
"""Numbers that are drawn for an episode: drag along each body axis, thrust, angular acceleration about each axis."""


def drawn_episode(count: int, settings: Randomisation, generator: torch.Generator) -> Tensor:
    """Return the numbers of episodes, (count, 7), even within their bounds."""
    draw = torch.rand(count, DRAWN, generator=generator, device=generator.device)
    drag, signed = draw.split([3, 4], dim=-1)
    thrust, turning = (2.0 * signed - 1.0).split([1, 3], dim=-1)
    return torch.cat(
        [settings.drag * drag, settings.thrust * thrust, settings.angular_acceleration * turning], dim=-1
    )


def drawn_wrench(drawn: Tensor, features: Tensor, inertia: Tensor) -> Tensor:
    """Return the force over mass and the torque of each machine, (batch, 6) m/s² and N·m, body frame.

    Args:
        drawn: of `drawn_episode`, (batch, 7).
        features: of `simgap.simulation.knn_residual.residual_features`, (batch, 7).
        inertia: principal moments, (3,) kg·m².
    """
    drag, thrust, turning = drawn.split([3, 1, 3], dim=-1)
    force = -drag * features[:, :3]
    lift = force[:, 2:] + thrust * features[:, 6:]
    return torch.cat([force[:, :2], lift, inertia * turning], dim=-1)


def nothing_left_over(features: Tensor) -> Tensor:
    """Return no force and no torque, (batch, 6): what a flight holds where nothing is drawn."""
    return torch.zeros_like(features[:, :6])
