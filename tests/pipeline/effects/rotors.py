"""Rotors of the tests' quadrotor, and what happens to it in hover."""

import torch
from hypothesis import strategies as st

from simgap.effects import Effect, effect_by_key
from tests.pipeline.platforms.machines import QUADROTOR

HOVER = QUADROTOR.hover_rotor_speed
SEED = st.integers(0, 10**6)


def of(key: str) -> Effect:
    return effect_by_key("quadrotor", key)


def hovering(samples: int) -> dict[str, torch.Tensor]:
    """Return one block of a machine that stands in the air."""
    still = torch.zeros(1, samples, 3, dtype=torch.float64)
    level = torch.tensor([1.0, 0.0, 0.0, 0.0], dtype=torch.float64).expand(1, samples, 4)
    speed = torch.full((1, samples, 4), HOVER, dtype=torch.float64)
    return {"attitude": level, "velocity": still, "body_rate": still, "rotor_speed": speed}
