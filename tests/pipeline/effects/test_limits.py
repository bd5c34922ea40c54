"""What an effect comes down to where a recording does not show what is its own: another effect, by name and by law."""

import pytest
import torch
from torch import Tensor

from simgap.effects import Effect, effect_by_key, effects_of
from simgap.simulation import FittedEffect, Simulator
from tests.pipeline.effects.responses import constants
from tests.pipeline.platforms.machines import JOINT, MACHINES, some_signals

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
        ("hysteresis", {"level": 0.3, "displacement": 0.02 * STEP}, FRICTION),
        ("hysteresis", {"level": 0.3, "displacement": 500.0}, SPRING),
    ],
)
def test_at_its_limit_an_effect_says_whose_law_it_is_and_the_laws_agree(name, values, same):
    effect, (other, others) = effect_by_key("joint", name), same
    assert effect.limit(values, swinging(), constants("joint")) == other
    found, expected = torque_of(effect, values), torque_of(effect_by_key("joint", other), others)
    aside = (found - expected).abs()
    assert float(aside.median()) < 0.02 * float(expected.abs().max())


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("stribeck_friction", {"extra_level": 0.3, "velocity": 0.3}),
        ("hysteresis", {"level": 0.3, "displacement": 0.1}),
    ],
)
def test_within_what_is_recorded_it_is_itself(name, values):
    assert effect_by_key("joint", name).limit(values, swinging(), constants("joint")) == ""


@pytest.mark.parametrize("group", ["drive", "steer"])
def test_friction_of_a_swerve_drive_that_never_fades_is_coulombs(group):
    effect = effect_by_key("swerve", f"stribeck_friction@{group}")
    signals = some_signals("swerve", (2, 50), seed=1)
    fastest = float(max(signals["drive_velocity"].abs().max(), signals["steer_velocity"].abs().max()))
    for velocity, expected in ((10.0 * fastest, "coulomb_friction"), (1e-3, "")):
        values = {"extra_level": 0.3, "velocity": velocity}
        assert effect.limit(values, signals, constants("swerve")) == expected


@pytest.mark.parametrize("kind", ["joint", "swerve"])
def test_friction_that_fades_where_no_sample_tells_the_direction_is_coulombs(kind):
    """Bells a sixth as wide as the sliding velocity, and half as wide again as it."""
    name, group = ("stribeck_friction", "") if kind == "joint" else ("stribeck_friction@steer", "steer_")
    speeds = torch.linspace(-6.0, 6.0, 4801, dtype=torch.float64)[None]
    speeds = speeds if kind == "joint" else speeds[..., None].expand(1, 4801, 4)  # one for each module
    signals = {f"{group}velocity": speeds, f"{group}sliding_velocity": torch.ones_like(speeds)}
    for velocity, expected in ((1.0 / 6.0, "coulomb_friction"), (1.5, "")):
        values = {"extra_level": 0.3, "velocity": velocity}
        assert effect_by_key(kind, name).limit(values, signals, constants(kind)) == expected


@pytest.mark.parametrize("kind", list(MACHINES))
def test_with_usual_values_a_limit_is_none_or_an_effect_of_the_same_catalogue(kind):
    signals, names = some_signals(kind, (2, 50), seed=1), {effect.name for effect in effects_of(kind)}
    for effect in effects_of(kind):
        assert effect.limit(effect.defaults(), signals, constants(kind)) in names | {""}
