from dataclasses import replace

import numpy as np
import pytest
import torch
from scipy.signal import cont2discrete

from simgap.errors import InputError
from simgap.models.second_order import SecondOrder, responses
from simgap.models.transfer_function import fit_axis, next_output
from simgap.models.windows import gather
from tests.pipeline.models import learnable
from tests.pipeline.models.rig import COMMANDED, rig

STEP = 0.02
SYSTEM = SecondOrder(gain=0.9, time_constant=0.08, damping=0.6)


def steps(samples, seed=0):
    return np.repeat(np.random.default_rng(seed).uniform(-3, 3, samples // 5), 5)


@pytest.mark.parametrize("delay", [0.0, 0.02, 0.033])
def test_the_response_is_that_of_the_exact_system(delay):
    """A delay of whole samples moves the input; one in between is seen on a grid three times as fine."""
    fine = 60
    command = steps(50)
    states, forced = responses(replace(SYSTEM, delay=delay), STEP, len(command))
    square = SYSTEM.time_constant**2
    a = np.array([[0.0, 1.0], [-1.0 / square, -2.0 * SYSTEM.damping / SYSTEM.time_constant]])
    b, c, d = np.array([[0.0], [SYSTEM.gain / square]]), np.array([[1.0, 0.0]]), np.zeros((1, 1))
    transition, effect, *_ = cont2discrete((a, b, c, d), STEP / fine)
    late = round(delay / STEP * fine)
    held = np.repeat(command, fine)
    held = np.concatenate([np.full(late, held[0]), held])[: len(held)]
    state, outputs = np.zeros(2), [0.0]
    for index, value in enumerate(held):
        state = transition @ state + effect[:, 0] * value
        if (index + 1) % fine == 0:
            outputs.append(state[0])
    assert np.allclose(forced @ command, outputs, atol=0.02 * (delay % STEP > 0) + 1e-9)
    assert np.allclose(states[0], [1.0, 0.0])


@pytest.mark.parametrize("delay", [0.0, 0.033])
def test_gain_time_constant_damping_and_delay_are_recovered(delay):
    true = replace(SYSTEM, delay=delay)
    inputs = np.stack([steps(100, seed) for seed in range(6)])
    free, forced = responses(true, STEP, 100)
    start = np.random.default_rng(9).normal(size=(6, 2))
    found = fit_axis(start @ free.T + inputs @ forced.T, inputs, STEP, most_delay=0.1 * (delay > 0))
    for name in ("gain", "time_constant", "damping", "delay"):
        assert getattr(found, name) == pytest.approx(getattr(true, name), rel=1e-4, abs=1e-6), name


def test_the_next_output_follows_from_a_window_alone():
    free, forced = responses(SYSTEM, STEP, 30)
    command = steps(30)
    outputs = free @ np.array([0.4, -2.0]) + forced @ command
    of_outputs, of_inputs = next_output(SYSTEM, STEP, 10)
    assert outputs[10] == pytest.approx(of_outputs @ outputs[:10] + of_inputs @ command[:10], abs=1e-9)


def test_a_whole_model_recovers_the_axes_of_a_rig_and_runs_freely():
    recorded = rig()
    train, validation, held = learnable.parts_of(recorded, "attitude")
    model = learnable.new_model("transfer_function", recorded, layout="attitude", sequence_length=10)
    assert model.fit(train, validation, learnable.QUICK) < 1e-8
    found = model.tensors()
    for index, axis in enumerate(COMMANDED):
        assert found["gain"][index] == pytest.approx(axis.gain, rel=1e-3)
        assert found["time_constant"][index] == pytest.approx(axis.time_constant, rel=1e-3)
        assert found["damping"][index] == pytest.approx(axis.damping, rel=1e-3)
    start = torch.tensor([0])
    states, actions = gather(held.states, start, 110), gather(held.actions, start, 109)
    assert torch.allclose(model.rollout(states[:, :10], actions), states[:, 10:], atol=1e-4)


def test_a_stretch_shorter_than_a_simulation_is_refused():
    recorded = rig(samples=60)
    train, validation, _ = learnable.parts_of(recorded, "attitude")
    model = learnable.new_model("transfer_function", recorded, layout="attitude", simulated=80)
    with pytest.raises(InputError, match=r"model\.simulated: no training segment holds 81 samples"):
        model.fit(train, validation, learnable.QUICK)
