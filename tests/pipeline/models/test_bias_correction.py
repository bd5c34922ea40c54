import pytest
import torch

from simgap.errors import InputError
from simgap.models.bias_correction import BiasCorrection
from simgap.models.step_scores import next_values, step_scores
from simgap.models.storage import DESCRIPTION_FILE, load_model, save_model
from tests.pipeline.models import learnable
from tests.pipeline.models.test_contract import change_description


def fitted():
    """Return a model of a linear plant whose predictions were made too small and shifted, and its series."""
    recorded = learnable.linear_joint()
    train, validation, held = learnable.parts_of(recorded)
    model = learnable.new_model("linear", recorded)
    model.fit(train, validation, learnable.QUICK)
    model.coefficients = 0.5 * model.coefficients
    model.coefficients[-1] += 0.02
    return model, validation, held


def test_a_line_is_recovered():
    predicted = torch.randn(100, 2, dtype=torch.float64, generator=torch.Generator().manual_seed(0))
    correction = BiasCorrection.fit(
        predicted, predicted * torch.tensor([0.5, -2.0]) + torch.tensor([1.0, 3.0])
    )
    assert correction.slope == pytest.approx((0.5, -2.0))
    assert correction.offset == pytest.approx((1.0, 3.0))


def test_what_never_varies_is_only_shifted():
    correction = BiasCorrection.fit(torch.full((10, 1), 2.0), torch.full((10, 1), 5.0))
    assert correction == BiasCorrection((1.0,), (3.0,))


def test_predictions_that_are_off_are_right_again_after_it():
    model, validation, held = fitted()
    before = next_values(model, {"": held})
    model.correct(validation)
    assert model.correction.slope == pytest.approx((2.0,), rel=1e-5)
    scores = step_scores(next_values(model, {"": held}), before)["velocity"]
    assert scores["mse"] < 1e-6 * scores["mse_uncorrected"]


def test_a_model_that_is_right_is_left_alone():
    model, validation, _ = fitted()
    model.correct(validation)
    first = model.correction
    model.correct(validation)
    assert model.correction == first


def test_a_loaded_model_corrects_as_the_saved_one(tmp_path):
    model, validation, held = fitted()
    model.correct(validation)
    save_model(model, tmp_path)
    states, actions = held.states[None, :2], held.actions[None, :20]
    assert torch.equal(load_model(tmp_path).rollout(states, actions), model.rollout(states, actions))


@pytest.mark.parametrize("values", [{"slope": [1.0]}, {"slope": [1.0, 1.0], "offset": [0.0, 0.0]}, "none"])
def test_a_correction_that_does_not_fit_is_refused(values, tmp_path):
    save_model(fitted()[0], tmp_path)
    change_description(tmp_path, lambda document: document.update(correction=values))
    with pytest.raises(InputError, match=DESCRIPTION_FILE):
        load_model(tmp_path)
