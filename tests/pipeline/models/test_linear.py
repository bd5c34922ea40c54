import torch

from simgap.models.evaluation import rollout_errors
from tests.pipeline.models import learnable


def test_a_linear_machine_is_predicted_exactly_over_many_steps():
    recorded = learnable.linear_joint()
    train, validation, held = learnable.parts_of(recorded)
    model = learnable.new_model("linear", recorded, sequence_length=1, ridge=0.0)
    assert model.fit(train, validation, learnable.QUICK) < 1e-20
    errors = rollout_errors(model, held, [1, 50, 200], 50)
    assert all(pair["model"] < 1e-9 for horizons in errors.values() for pair in horizons.values())


def test_a_longer_window_is_no_worse_on_a_linear_machine():
    recorded = learnable.linear_joint()
    train, validation, held = learnable.parts_of(recorded)
    model = learnable.new_model("linear", recorded, sequence_length=6)
    model.fit(train, validation, learnable.QUICK)
    assert rollout_errors(model, held, [50], 50)["velocity"]["h50"]["model"] < 1e-4


def test_the_penalty_draws_coefficients_to_zero():
    recorded = learnable.linear_joint()
    train, validation, _ = learnable.parts_of(recorded)
    norms = []
    for ridge in (0.0, 1.0, 100.0):
        model = learnable.new_model("linear", recorded, ridge=ridge)
        model.fit(train, validation, learnable.QUICK)
        norms.append(float(torch.linalg.vector_norm(model.tensors()["coefficients"][:-1])))
    assert norms[0] > norms[1] > norms[2]
