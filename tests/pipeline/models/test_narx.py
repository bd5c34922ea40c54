from dataclasses import replace

import pytest
import torch

from simgap.errors import InputError
from simgap.models.contract import FitContext
from simgap.models.free_run import free_run_scores
from simgap.models.settings import Training
from simgap.models.windows import Series
from tests.pipeline.models import learnable
from tests.pipeline.models.rig import rig

LONG = Training(max_epochs=400, patience=50)


def arx(samples=200, seed=0):
    """Return a series of y(k+1) = 1.5·y(k) − 0.7·y(k−1) + 0.5·u(k) + 0.2·u(k−1) on three axes."""
    random = torch.Generator().manual_seed(seed)
    actions = 2.0 * torch.rand(samples, 3, generator=random, dtype=torch.float64) - 1.0
    states = torch.zeros(samples, 3, dtype=torch.float64)
    for k in range(1, samples - 1):
        states[k + 1] = 1.5 * states[k] - 0.7 * states[k - 1] + 0.5 * actions[k] + 0.2 * actions[k - 1]
    return Series(states, actions, torch.tensor([[0, samples]]), 0.02)


def model_of(**options):
    return learnable.new_model("narx", rig(), layout="attitude", **options)


def test_a_linear_plant_is_recovered_to_a_thousandth():
    model = model_of(sequence_length=2, hidden=1)
    loss = model.fit(arx(seed=0), arx(seed=1), LONG)
    assert loss**0.5 < 1e-3  # of the spread of an increment
    scores = free_run_scores(model, arx(seed=2), duration=2.0)
    for score in scores.values():
        assert score["mse"] ** 0.5 < 1e-2
        assert score["correlation"] > 0.9999


def test_what_lies_beyond_the_delays_is_not_seen():
    model = model_of(sequence_length=6, input_delays=1, output_delays=3, hidden=3)
    model.fit(arx(), arx(seed=1), learnable.QUICK)
    window = torch.randn(1, 6, 6, dtype=torch.float64, generator=torch.Generator().manual_seed(3))
    reference = model.increments(window)
    for back in range(1, 7):
        for columns, seen in ((slice(0, 3), back <= 3), (slice(3, 6), back <= 1)):
            changed = window.clone()
            changed[:, -back, columns] += 1.0
            assert torch.equal(model.increments(changed), reference) != seen


@pytest.mark.parametrize("options", [{"input_delays": 5}, {"output_delays": 0}, {"hidden": 0}])
def test_delays_that_do_not_fit_are_refused(options):
    model = model_of(**({"sequence_length": 4} | options))
    with pytest.raises(InputError, match=rf"model\.{next(iter(options))}"):
        model.fit(arx(), arx(seed=1), learnable.QUICK)


def test_the_losses_of_every_step_are_told():
    told = []
    context = FitContext(log=lambda losses, step: told.append((step, losses)))
    model = model_of(sequence_length=2, hidden=2)
    model.fit(arx(), arx(seed=1), replace(LONG, max_epochs=5), context)
    assert [step for step, _ in told] == list(range(5))
    assert told[-1][1]["train_loss"] < told[0][1]["train_loss"]
