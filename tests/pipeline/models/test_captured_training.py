"""Training on a GPU: its CUDA graphs run here operation by operation, and as graphs where there is a GPU."""

from dataclasses import replace

import pytest
import torch

from simgap.models.accelerator import accelerated
from simgap.models.contract import FitContext
from simgap.models.descent import Descent
from simgap.models.evaluation import rollout_errors
from simgap.models.rollout_training import RolloutRegression
from simgap.models.settings import Training
from simgap.simulation.captured import CapturedFunction
from tests.pipeline.asking import Asking
from tests.pipeline.models import learnable
from tests.pipeline.models.test_training import Killed, kill_at

SHORT = Training(max_epochs=3, patience=3, batch_size=100, steps=4, growth=0.5)
KINDS = ["fnn", "lstm", "tcn", "black_box", "hybrid_parallel", "hybrid_serial"]
on_gpu = pytest.mark.skipif(not torch.cuda.is_available(), reason="needs a GPU")


@pytest.fixture(autouse=True)
def uncompiled(monkeypatch):
    """A compiler cannot see through the checks of shapes that are on in tests."""
    monkeypatch.setattr("simgap.models.rollout_training._compiled", lambda advance: advance)


@pytest.fixture(scope="module")
def parts():
    recorded = learnable.quadrotor()
    return recorded, *learnable.parts_of(recorded)


def fitted(name, parts, training=SHORT, context=None, **options):
    recorded, train, validation, _ = parts
    model = learnable.new_model(name, recorded, **options)
    model.fit(train, validation, training, context or FitContext(3))
    return model.tensors()


@pytest.mark.parametrize("name", KINDS)
def test_captured_training_does_what_the_other_does(name, parts, monkeypatch):
    plain = fitted(name, parts)

    def capturing(module):
        module.place()
        module.improve, module.judge = module.captured()

    monkeypatch.setattr(Descent, "on_fit_start", capturing)
    captured = fitted(name, parts)
    assert all(torch.equal(own, captured[key]) for key, own in plain.items())


@pytest.mark.parametrize("name", KINDS)
@pytest.mark.parametrize("forcing", [False, True])
def test_a_step_asks_nothing_of_the_device(name, forcing, parts):
    recorded, train, validation, _ = parts
    model = learnable.new_model(name, recorded)
    training = replace(SHORT, max_epochs=1, teacher_forcing=forcing)
    model.fit(train, validation, training)
    module = RolloutRegression(model, train, validation, training, 0)
    batch = next(iter(module.train_dataloader()))
    with Asking():
        module.taught(*batch).backward()


def test_a_captured_function_works_at_fixed_places_for_each_shape():
    function = CapturedFunction(lambda one, other: one + other, torch.device("cpu"))
    given = torch.arange(3.0), torch.ones(3)
    first = function(*given)
    assert torch.equal(first, torch.tensor([1.0, 2.0, 3.0]))
    assert torch.equal(function(torch.zeros(2), torch.ones(2)), torch.ones(2))
    assert torch.equal(function(given[0], given[0]), 2 * given[0])
    assert torch.equal(given[1], torch.ones(3))


@on_gpu
@pytest.mark.parametrize("name", KINDS)
def test_a_training_on_the_gpu_ends_where_it_does_on_the_cpu(name, parts, monkeypatch):
    """In what it predicts: weights before a normalisation have no gradient but rounding."""
    still = {"dropout": []} if name in {"fnn", "lstm", "tcn"} else {}
    recorded, train, validation, held = parts
    ends = []
    for there in (True, False):
        monkeypatch.setattr(torch.cuda, "is_available", lambda there=there: there)
        model = learnable.new_model(name, recorded, **still)
        loss = model.fit(train, validation, SHORT, FitContext(3))
        assert all(tensor.device.type == "cpu" for tensor in model.tensors().values())
        errors = rollout_errors(model, held, [1, 5], 50)
        ends.append([loss, *(error["model"] for horizons in errors.values() for error in horizons.values())])
    assert ends[0] == pytest.approx(ends[1], rel=0.02)


@on_gpu
@pytest.mark.parametrize("name", ["tcn", "hybrid_serial"])
def test_a_killed_training_on_the_gpu_goes_on_to_the_same_end(name, parts, tmp_path):
    undisturbed = fitted(name, parts)
    with pytest.raises(Killed):
        fitted(name, parts, context=FitContext(3, tmp_path, kill_at(1)))
    resumed = fitted(name, parts, context=FitContext(3, tmp_path))
    assert all(torch.equal(own, resumed[key]) for key, own in undisturbed.items())


@on_gpu
def test_a_model_is_scored_on_the_gpu_as_on_the_cpu(parts):
    recorded, train, validation, held = parts
    model = learnable.new_model("hybrid_parallel", recorded)
    model.fit(train, validation, SHORT)
    expected = rollout_errors(model, held, [1, 5], 50)
    with accelerated(model):
        found = rollout_errors(model, held, [1, 5], 50)
    for quantity, horizons in expected.items():
        for horizon, errors in horizons.items():
            assert found[quantity][horizon] == pytest.approx(errors, rel=1e-4)
