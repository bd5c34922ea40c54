"""What an effect comes down to where a recording does not show what is its own: the law of another effect."""

import pytest
import torch
from torch import Tensor

from simgap.effects import Effect, effect_by_key
from simgap.simulation import FittedEffect, Simulator
from tests.pipeline.effects.responses import constants
from tests.pipeline.platforms.machines import JOINT

TIME_STEP = 0.01  # s
SWING = 0.8 * torch.sin(torch.linspace(0.0, 12.0, 1200, dtype=torch.float64))[None]  # rad
STEP = float(SWING.diff(dim=1).abs().median())
FRICTION, SPRING = ("coulomb_friction", {"level": 0.3}), ("linear_stiffness", {"stiffness": 0.3 / 500.0})


def swinging() -> dict[str, Tensor]:
    velocity = torch.gradient(SWING, spacing=TIME_STEP, dim=1)[0]
    return {"position": SWING, "velocity": velocity, "effort": torch.zeros_like(SWING)}


def torque_of(effect: Effect, values: dict[str, float]) -> Tensor:
    simulator = Simulator(JOINT, (FittedEffect(effect, values),))
    signals = simulator.along_time(swinging(), TIME_STEP)
    return effect.wrench(signals, values, constants("joint"))["torque"]


@pytest.mark.parametrize(
    ("name", "values", "same"),
    [
        ("stribeck_friction", {"extra_level": 0.3, "velocity": 300.0}, FRICTION),
        ("hysteresis", {"level": 0.3, "displacement": 0.02 * STEP, "asymmetry": 0.0}, FRICTION),
        ("hysteresis", {"level": 0.15 * 2.0**0.5, "displacement": 0.02 * STEP, "asymmetry": -0.5}, FRICTION),
        ("hysteresis", {"level": 0.3, "displacement": 500.0, "asymmetry": 0.0}, SPRING),
        ("hysteresis", {"level": 0.3, "displacement": 500.0, "asymmetry": -1.4}, SPRING),
    ],
)
def test_at_its_limit_an_effect_has_the_law_of_another(name, values, same):
    effect, (other, others) = effect_by_key("joint", name), same
    found, expected = torque_of(effect, values), torque_of(effect_by_key("joint", other), others)
    aside = (found - expected).abs()
    assert float(aside.median()) < 0.02 * float(expected.abs().max())
