"""The state space finds a plant that is linear in what it is given, and that of a swerve drive is."""

from dataclasses import replace

import numpy as np
import pytest
import torch

from simgap.errors import InputError
from simgap.models.registry import MODELS, model_settings
from simgap.models.settings import Training
from simgap.models.state_space import low_passed
from simgap.models.swerve_chassis_layout import SwerveChassisLayout
from simgap.models.swerve_layout import four
from simgap.models.windows import Series
from tests.pipeline.models import learnable

LAYOUT = SwerveChassisLayout((*four("drive_voltage"), *four("steer_voltage")))


def driven(seed, samples=1500):
    """Return a swerve drive whose increments are linear in the layout's regressors, and their coefficients."""
    truth = torch.from_numpy(np.random.default_rng(0).normal(scale=0.02, size=(59, 11)))
    truth[:11] -= 0.2 * torch.eye(11, dtype=torch.float64)
    truth[27:51] *= 0.1  # products of velocities, small enough not to run away
    random = torch.Generator().manual_seed(seed)
    state = torch.zeros(15, dtype=torch.float64)
    actions = torch.randn(samples, 8, generator=random, dtype=torch.float64)
    states = []
    for action in actions:
        states.append(state)
        increment = LAYOUT.regressors(LAYOUT.encode(state, action)) @ truth
        state = LAYOUT.advance(state, increment, 0.02)
    return Series(torch.stack(states), actions, torch.tensor([[0, samples]]), 0.02), truth


def fitted(train, held, **options):
    settings = model_settings({"name": "state_space", "ridge": 0.0} | options)
    model = MODELS["state_space"](LAYOUT, settings, 0.02)
    return model, model.fit(train, held, Training())


def test_a_plant_that_is_linear_in_the_products_is_recovered():
    train, truth = driven(1)
    held, _ = driven(2)
    model, loss = fitted(train, held, cutoff=None)
    scale = model.scaler.spread[:, None]
    found = model.coefficients[:-1] / scale
    assert loss < 1e-16
    assert torch.allclose(found, truth, atol=1e-9)


def test_a_rollout_of_a_recovered_plant_stays_with_it():
    train, _ = driven(1)
    held, _ = driven(2)
    model, _ = fitted(train, held, cutoff=None)
    rolled = model.rollout(held.states[None, :1], held.actions[None, :200])
    errors = LAYOUT.errors(rolled[0], held.states[1:201])
    usual = LAYOUT.errors(torch.zeros_like(rolled[0]), held.states[1:201])
    assert all(error.max() < 1e-6 * usual[name].mean() for name, error in errors.items())


def test_a_low_pass_keeps_what_is_slow_takes_what_is_fast_and_shifts_nothing():
    time = torch.arange(400, dtype=torch.float64)[:, None]
    slow, fast = torch.sin(0.02 * torch.pi * time), torch.sin(0.8 * torch.pi * time)
    series = Series(slow + fast, fast, torch.tensor([[0, 200], [200, 400]]), 0.02)
    smooth = low_passed(series, 0.3, 4)
    inside = torch.cat([torch.arange(20, 180), torch.arange(220, 380)])
    assert torch.allclose(smooth.states[inside], slow[inside], atol=1e-3)
    assert smooth.actions[inside].abs().max() < 1e-3


def test_segments_are_filtered_by_themselves():
    series, _ = driven(3, samples=60)
    halves = replace(series, bounds=torch.tensor([[0, 30], [30, 30], [30, 60]]))
    first = Series(series.states[:30], series.actions[:30], torch.tensor([[0, 30]]), 0.02)
    assert torch.equal(low_passed(halves, 0.3, 4).states[:30], low_passed(first, 0.3, 4).states)


@pytest.mark.parametrize("cutoff", [0.0, 1.0, -0.5])
def test_a_cutoff_beyond_the_spectrum_is_refused(cutoff):
    train, _ = driven(1, samples=100)
    with pytest.raises(InputError, match=r"model\.cutoff"):
        fitted(train, train, cutoff=cutoff)


def test_products_turn_with_the_wheels():
    """Turning robot frame and wheels together turns each module's pair of products of drive and voltage."""
    state, action = torch.randn(15, dtype=torch.float64), torch.randn(8, dtype=torch.float64)
    turned, turn = state.clone(), torch.tensor(0.7, dtype=torch.float64)
    turned[11:] += turn
    before, after = (
        LAYOUT.regressors(LAYOUT.encode(one, action))[27:].view(2, 4, 4) for one in (state, turned)
    )
    expected = torch.stack(
        [
            torch.cos(turn) * before[0] - torch.sin(turn) * before[1],
            torch.sin(turn) * before[0] + torch.cos(turn) * before[1],
        ]
    )
    assert torch.allclose(after, expected)


def test_without_products_it_is_the_linear_model():
    train, validation, _ = learnable.parts_of(learnable.linear_joint())
    model = learnable.new_model("state_space", learnable.linear_joint(), cutoff=None)
    linear = learnable.new_model("linear", learnable.linear_joint(), sequence_length=1)
    model.fit(train, validation, learnable.QUICK)
    linear.fit(train, validation, learnable.QUICK)
    assert torch.allclose(model.coefficients, linear.coefficients, atol=1e-12)
