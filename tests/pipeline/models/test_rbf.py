from dataclasses import replace

import pytest
import torch

from simgap.errors import InputError
from simgap.models.contract import FitContext
from simgap.models.moving_window import moving_window_ratios
from simgap.models.orthogonal_least_squares import choose
from simgap.models.rbf import RadialBasisModel
from simgap.models.residual_ratios import ratios, residual_ratios
from tests.pipeline.models import learnable


def radial(points, centres, width=0.1):
    return torch.exp(-torch.cdist(points, centres).square() / (2 * width**2))


def test_the_centres_of_a_sum_of_radial_functions_are_found():
    random = torch.Generator().manual_seed(0)
    points = torch.rand(300, 2, generator=random, dtype=torch.float64)
    true = torch.tensor([17, 80, 211])
    apart = [[0.1, 0.1], [0.9, 0.2], [0.5, 0.9]]  # so far that none hides another
    points[true] = torch.tensor(apart, dtype=torch.float64)
    weights = torch.tensor([[2.0, 0.5], [-1.5, 1.0], [1.0, -2.0]], dtype=torch.float64)
    targets = radial(points, points[true]) @ weights
    design = radial(points, points[:250])
    energy = float(targets.square().sum())
    choice = choose(design.T @ design, design.T @ targets, energy, most=20, goal=1e-9)
    assert sorted(choice.order.tolist()) == true.tolist()
    assert torch.allclose(choice.weights[choice.order.argsort()], weights, atol=1e-6)


def test_the_weights_are_those_of_least_squares_on_the_chosen_regressors():
    random = torch.Generator().manual_seed(1)
    design = torch.randn(200, 30, generator=random, dtype=torch.float64)
    targets = torch.randn(200, 3, generator=random, dtype=torch.float64)
    energy = float(targets.square().sum())
    choice = choose(design.T @ design, design.T @ targets, energy, most=10, goal=0.0, first=2)
    chosen = design[:, choice.order]
    expected = torch.linalg.lstsq(chosen, targets).solution
    assert set(choice.order[:2].tolist()) == {0, 1}
    assert torch.allclose(choice.weights, expected, atol=1e-10)
    left = float((targets - chosen @ expected).square().sum()) / energy
    assert float(choice.unexplained[-1]) == pytest.approx(left)


def test_a_regressor_that_is_there_already_is_not_taken_again():
    column = torch.randn(50, 1, generator=torch.Generator().manual_seed(2), dtype=torch.float64)
    design = torch.cat([column, 2.0 * column], dim=1)
    choice = choose(design.T @ design, design.T @ column, float(column.square().sum()), most=2, goal=-1.0)
    assert len(choice.order) == 1


def test_a_tighter_goal_takes_more_neurons():
    recorded = learnable.quadrotor()
    train, validation, _ = learnable.parts_of(recorded)
    sizes = []
    for goal in (1.0, 0.5, 1e-3, 1e-5):
        model = learnable.new_model("rbf", recorded, goal=goal, neurons=40)
        assert isinstance(model, RadialBasisModel)
        model.fit(train, validation, learnable.QUICK)
        sizes.append(len(model.centres))
    assert sizes == sorted(sizes)
    assert sizes[0] == 0  # the linear part alone
    assert sizes[1] < sizes[-1] <= 40


@pytest.mark.parametrize("key", ["width", "candidates", "neurons", "goal", "ridge"])
def test_settings_that_make_no_network_are_refused(key):
    recorded = learnable.linear_joint()
    train, validation, _ = learnable.parts_of(recorded)
    with pytest.raises(InputError, match=rf"model\.{key}"):
        learnable.new_model("rbf", recorded, **{key: -1}).fit(train, validation, learnable.QUICK)


def test_the_ratios_of_known_residuals():
    measured = torch.tensor([1.0, 3.0, 1.0, 3.0], dtype=torch.float64)  # ‖y − ȳ‖ = 2
    residual = torch.tensor([0.5, 0.0, 0.0, 0.0], dtype=torch.float64)
    assert ratios(measured, residual) == {"P_f": 0.75, "P_i": 3.0}
    assert ratios(measured, measured - 2.0) == {"P_f": 0.0, "P_i": 0.0}
    # A residual of twice the spread is worse than the mean, and says so.
    assert ratios(measured, 2.0 * (measured - 2.0)) == {"P_f": -1.0, "P_i": -0.5}


def test_the_ratios_stand_beside_the_neurons_and_the_samples_that_they_took():
    recorded = learnable.quadrotor()
    train, validation, held = learnable.parts_of(recorded)
    model = learnable.new_model("rbf", recorded, goal=1e-3)
    told = []
    model.fit(train, validation, learnable.QUICK, FitContext(log=lambda numbers, step: told.append(numbers)))
    windows = len(train.starts(model.settings.sequence_length + 1))
    size = residual_ratios(model, held)["size"]
    assert size["neurons"] == len(model.tensors()["centres"])
    assert size["samples"] == windows
    assert 0.0 < size["achieved_goal"] <= 1e-3
    assert told == [size]


def test_each_target_can_have_a_network_of_its_own():
    recorded = learnable.swerve()
    train, validation, _ = learnable.parts_of(recorded)
    model = learnable.new_model("rbf", recorded, goal=0.0, neurons=3, shared=False)
    model.fit(train, validation, learnable.QUICK)
    linear = 1 + model.centres.shape[1]
    radial = model.coefficients[linear:]
    assert ((radial != 0.0).sum(0) <= 3).all()
    assert len(model.centres) > 3
    assert model.size["neurons"] <= 3.0


def test_the_spread_rule_takes_the_width_from_the_centres():
    recorded = learnable.linear_joint()
    train, validation, _ = learnable.parts_of(recorded)
    model = learnable.new_model("rbf", recorded, width=None, neurons=8, candidates=100_000)
    model.fit(train, validation, learnable.QUICK)
    examples = model.examples(train, "training")
    windows = model.inputs.apply(examples.take(torch.arange(len(examples)))[0]).flatten(1)
    apart = torch.cdist(windows, windows).max() / windows.shape[1] ** 0.5
    assert float(model.width) == pytest.approx(float(apart) / 4.0)


def test_a_moving_window_follows_a_machine_that_changes():
    """The gain of an input doubles half-way: a model of all runs before cannot know, one of the last second does."""
    recorded = learnable.linear_joint()
    train, validation, held = learnable.parts_of(recorded)
    changed = replace(
        held, actions=held.actions * torch.where(torch.arange(len(held)) > 150, 0.5, 1.0)[:, None]
    )
    model = learnable.new_model("linear", recorded, sequence_length=1)
    model.fit(train, validation, learnable.QUICK)
    training = replace(learnable.QUICK, moving_window=1.0, moving_step=0.2)
    moving = moving_window_ratios(model, changed, training, FitContext())["velocity"]
    assert set(moving) == {"P_f", "P_i"}
    assert moving["P_f"] > residual_ratios(model, changed)["velocity"]["P_f"] + 0.05
    with pytest.raises(InputError, match=r"train\.moving_window"):
        moving_window_ratios(model, changed, replace(training, moving_window=60.0), FitContext())


def test_noise_on_the_inputs_is_as_large_as_asked_and_repeats():
    train = learnable.parts_of(learnable.linear_joint())[0]
    noisy = train.with_noise(0.5, seed=3)
    added = noisy.actions - train.actions
    assert float(added.std() / train.actions.std()) == pytest.approx(0.5, rel=0.1)
    assert torch.equal(noisy.states, train.states)
    assert torch.equal(noisy.actions, train.with_noise(0.5, seed=3).actions)
    assert train.with_noise(0.0, seed=3) is train
    with pytest.raises(InputError, match=r"train\.noise"):
        train.with_noise(-0.1, seed=3)


def test_every_target_has_its_ratios():
    recorded = learnable.swerve()
    train, validation, held = learnable.parts_of(recorded)
    model = learnable.new_model("linear", recorded)
    model.fit(train, validation, learnable.QUICK)
    found = residual_ratios(model, held)
    assert set(found) == set(model.layout.targets)
    assert all(entry["P_f"] > 0.99 for entry in found.values())
