"""Training through open-loop predictions."""

from dataclasses import replace
from unittest.mock import patch

import numpy as np
import pytest
import torch

from simgap.errors import InputError
from simgap.models.contract import FitContext, Teacher
from simgap.models.evaluation import rollout_errors
from simgap.models.rollout_training import RolloutRegression, usual_changes
from simgap.models.settings import Training
from tests.pipeline.models import learnable
from tests.pipeline.models.test_training import Killed

SHORT = Training(max_epochs=4, patience=4, batch_size=128, steps=5)
NOISE = 0.1  # standard deviation of what is measured of the mass on a spring


@pytest.fixture(scope="module")
def parts():
    recorded = learnable.linear_joint()
    return recorded, *learnable.parts_of(recorded)


def noisy(recorded):
    """Return the recording as sensors see it."""
    rng = np.random.default_rng(0)
    frame = recorded.frame.copy()
    frame[["position", "velocity"]] += NOISE * rng.normal(size=(len(frame), 2))
    return replace(recorded, frame=frame)


# Four epochs of single steps come first, but for a hybrid.
@pytest.mark.parametrize(("name", "epoch"), [("black_box", 2), ("black_box", 5), ("hybrid_serial", 1)])
def test_a_killed_training_goes_on_to_the_same_end(name, epoch, parts, tmp_path):
    recorded, train, validation, _ = parts
    undisturbed, killed, resumed = (learnable.new_model(name, recorded) for _ in range(3))
    heard = []

    def kill(metrics, step):
        heard.append(step)
        if len(heard) > epoch:
            raise Killed

    loss = undisturbed.fit(train, validation, SHORT, FitContext(3))
    with pytest.raises(Killed):
        killed.fit(train, validation, SHORT, FitContext(3, tmp_path, kill))
    assert resumed.fit(train, validation, SHORT, FitContext(3, tmp_path)) == loss
    assert all(torch.equal(own, resumed.tensors()[key]) for key, own in undisturbed.tensors().items())


def flying(**training):
    """Return a black box with a network for velocity and one for body rate, and what trains it."""
    recorded = learnable.quadrotor()
    train, validation, _ = learnable.parts_of(recorded)
    model = learnable.new_model("black_box", recorded, separate=True)
    settings = replace(SHORT, max_epochs=1, **training)
    model.fit(train, validation, settings)
    return model, RolloutRegression(model, train, validation, settings, 0)


def test_a_teacher_gives_some_states_and_leaves_the_others_to_the_model():
    model, module = flying()
    states, _ = batch = next(iter(module.train_dataloader()))
    true, free = states[:, module.known :], module.model.rollout(states[:, : module.known], batch[1])
    nothing, everything = (torch.full((13,), given) for given in (False, True))
    with torch.no_grad():
        for forced, expected in ((nothing, free), (everything, true)):
            teacher = Teacher(true, forced)
            assert torch.equal(model.unroll(states[:, : module.known], batch[1], teacher), expected)


@pytest.mark.parametrize(("lesson", "taught"), [(0, 0), (1, 1)])
def test_a_lesson_on_one_quantity_teaches_its_own_network_alone(lesson, taught):
    model, module = flying(teacher_forcing=True)
    model.network.zero_grad()
    module._loss(*next(iter(module.train_dataloader())), module.lessons[lesson]).backward()
    for number, network in enumerate(model.network.networks):
        learned = any(p.grad is not None and bool(p.grad.any()) for p in network.parameters())
        assert learned == (number == taught)
        assert all(p.grad is None or bool(p.grad.isfinite().all()) for p in network.parameters())


def test_a_machine_without_groups_has_no_teacher(parts):
    _, train, validation, _ = parts
    model = learnable.new_model("black_box", parts[0])
    with pytest.raises(InputError, match=r"train\.teacher_forcing"):
        model.fit(train, validation, replace(SHORT, max_epochs=1, teacher_forcing=True))


def test_the_loss_falls_and_the_best_weights_are_kept(parts):
    recorded, train, validation, _ = parts
    model = learnable.new_model("hybrid_parallel", recorded, motion={"name": "linear"})
    losses = []
    context = FitContext(0, None, lambda metrics, step: losses.append(metrics["validation_loss"]))
    distorted = replace(train, actions=train.actions.tanh())
    loss = model.fit(distorted, replace(validation, actions=validation.actions.tanh()), SHORT, context)
    assert loss == min(losses) < losses[0]


def test_training_through_rollouts_predicts_further_than_training_of_single_steps():
    """Noise of the sensors makes single steps say too little of what holds for long."""
    clean, recorded = learnable.linear_joint(), noisy(learnable.linear_joint())
    train, validation, _ = learnable.parts_of(recorded)
    held = learnable.parts_of(clean)[2]
    training = Training(max_epochs=10, patience=10, batch_size=32)
    errors = []
    for steps in (1, 15):
        model = learnable.new_model("fnn", recorded, sequence_length=1, hidden=[8], dropout=[])
        model.fit(train, validation, replace(training, steps=steps), FitContext(0))
        errors.append(rollout_errors(model, held, [50], 200)["position"]["h50"]["model"])
    single, through = errors
    assert through < 0.8 * single


def test_networks_are_trained_in_single_precision(parts):
    recorded, train, validation, _ = parts
    model = learnable.new_model("hybrid_parallel", recorded)
    model.fit(train, validation, replace(SHORT, max_epochs=1))
    assert {weight.dtype for weight in model.network.parameters()} == {torch.float32}


def test_the_usual_change_is_that_of_the_recorded_states(parts):
    recorded, train, _, _ = parts
    model = learnable.new_model("linear", recorded)
    usual = usual_changes(model.layout, train, 3)
    first, last = train.bounds.T
    velocity = train.states[:, 1]
    starts = train.starts(4)
    assert len(starts) == int((last - first - 3).sum())
    assert usual["velocity"][2] == pytest.approx(
        float((velocity[starts + 3] - velocity[starts]).abs().mean())
    )


@pytest.mark.parametrize(
    ("growth", "horizons"), [(0.0, [8, 8, 8, 8]), (0.75, [2, 4, 6, 8]), (0.5, [3, 6, 8, 8])]
)
def test_the_horizon_grows_to_the_steps(growth, horizons, parts):
    recorded, train, validation, _ = parts
    model = learnable.new_model("hybrid_parallel", recorded)
    module = RolloutRegression(model, train, validation, replace(SHORT, steps=8, growth=growth), 0)
    seen = []
    for epoch in range(4):
        with patch.object(RolloutRegression, "current_epoch", epoch):
            states, _ = next(iter(module.train_dataloader()))
        seen.append(states.shape[1] - model.settings.sequence_length)
    assert seen == horizons
    assert next(iter(module.val_dataloader()))[0].shape[1] == model.settings.sequence_length + 8


def test_a_growth_that_is_no_share_is_refused(parts):
    recorded, train, validation, _ = parts
    model = learnable.new_model("hybrid_parallel", recorded)
    with pytest.raises(InputError, match=r"train\.growth"):
        model.fit(train, validation, replace(SHORT, growth=1.5))


def test_steps_longer_than_every_segment_are_refused(parts):
    recorded, train, validation, _ = parts
    model = learnable.new_model("black_box", recorded)
    with pytest.raises(InputError, match=r"train\.steps: no training segment holds"):
        model.fit(train, validation, replace(SHORT, steps=1000, max_epochs=1))
