"""The compiled search for first swings pulls as the cable of the simulator does."""

import numpy as np
import pytest
import torch

from simgap.physics.cable import Cable, pull
from simgap.physics.swing_search import Swinging, first_swings

LENGTH, RATIO, STEP, MEMORY = 0.6, 0.2, 0.03, 0.2
STEPS = 150


def record(towards: torch.Tensor, turning: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
    """Return apparent gravity, (1, steps, 3), of a machine that stands upright and that only a swinging load pulls.

    What is felt is minus the apparent gravity: what the load pulls along x and y is what is missing there.
    """
    cable, gravity = Cable(LENGTH, 9.81, STEP), torch.zeros(1, STEPS, 3, dtype=torch.float64)
    gravity[..., 2] = -9.81
    for _ in range(10):  # the pull changes what acts on the cable
        directions, rates = cable.steps(towards, turning, gravity, 1)
        pulled = RATIO * pull(directions, rates, gravity, LENGTH)
        gravity = torch.cat([-pulled[..., :2], gravity[..., 2:]], dim=-1)
    return gravity, directions


@pytest.mark.slow
def test_a_known_first_swing_is_found() -> None:
    """Without noise, a swing of 0.3 rad is found to a hundredth of a rad, whatever the prior says."""
    angle = 0.3
    towards = torch.tensor([[np.sin(angle), 0.0, -np.cos(angle)]], dtype=torch.float64)
    gravity, directions = record(towards, torch.zeros_like(towards))
    axes = torch.eye(3, dtype=torch.float64)[:2].expand(1, STEPS, 2, 3)
    resting = gravity[:, 0] / gravity[:, 0].norm(dim=-1, keepdim=True)
    sides = axes[:, 0] - (axes[:, 0] @ resting[..., None]) * resting[:, None]
    counted = torch.arange(1.0, STEPS + 1.0, dtype=torch.float64)[None]
    pace = float(np.sqrt(9.81 / LENGTH))
    arrays = [each.contiguous().numpy() for each in (gravity, axes, counted, resting, sides)]
    found, rate = first_swings(*arrays, Swinging(LENGTH, pace, STEP, RATIO, MEMORY))
    np.testing.assert_allclose(found, directions[:, 0].numpy(), atol=0.01)
    np.testing.assert_allclose(rate, 0.0, atol=0.05)
