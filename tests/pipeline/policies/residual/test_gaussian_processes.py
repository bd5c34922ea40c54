"""The processes against scikit-learn's, and against what the data were drawn from."""

import numpy as np
import pytest
import torch
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel

from pipeline.policies.residual.gaussian_processes import fit
from pipeline.policies.residual.realisations import draw

NOISE = 0.1


@pytest.fixture(scope="module")
def data():
    random = torch.Generator().manual_seed(0)
    features = torch.rand(200, 3, generator=random, dtype=torch.float64) * 4.0 - 2.0
    truth = torch.stack([torch.sin(2.0 * features[:, 0]), 0.5 * features[:, 1] ** 2 + 3.0], 1)
    return features, truth + NOISE * torch.randn(truth.shape, generator=random, dtype=torch.float64), truth


@pytest.fixture(scope="module")
def processes(data):
    return fit(data[0], data[1], judged_by=200, iterations=80)


def test_noise_and_what_matters_are_found(data, processes):
    noise = processes.noise.sqrt() * processes.output_scale[1]
    torch.testing.assert_close(noise, torch.full_like(noise, NOISE), rtol=0.25, atol=0)
    assert int(processes.lengths[0].argmin()) == 0
    assert int(processes.lengths[1].argmin()) == 1
    error = processes.mean(data[0]) - data[2]
    assert float(error.square().mean().sqrt()) < 0.05


def test_the_posterior_is_that_of_scikit_learn(data, processes):
    queries = torch.linspace(-3.0, 3.0, 12, dtype=torch.float64)[:, None].expand(-1, 3)
    mean, deviation = processes.mean(queries), processes.deviation(queries)
    for place in range(2):
        kernel = ConstantKernel(float(processes.variance[place])) * RBF(processes.lengths[place].numpy())
        peer = GaussianProcessRegressor(kernel, alpha=float(processes.noise[place]), optimizer=None)
        peer.fit(processes.inputs.numpy(), processes.outputs[place].numpy())
        theirs, spread = peer.predict(processes.scaled(queries).numpy(), return_std=True)
        size, middle = (float(processes.output_scale[row, place]) for row in (1, 0))
        np.testing.assert_allclose(mean[:, place], middle + size * theirs, atol=1e-3)
        np.testing.assert_allclose(deviation[:, place], size * spread, atol=1e-3)


def test_the_search_does_not_end_below_the_likelihood_that_scikit_learn_finds(data, processes):
    kernel = ConstantKernel(1.0, (0.01, 4.0)) * RBF([1.0] * 3, (0.1, 30.0)) + WhiteKernel(0.1, (1e-3, 1.5))
    peer = GaussianProcessRegressor(kernel, random_state=0)
    peer.fit(processes.inputs.numpy(), processes.outputs[0].numpy())
    ours = ConstantKernel(float(processes.variance[0])) * RBF(processes.lengths[0].numpy())
    ours += WhiteKernel(float(processes.noise[0]))
    assert peer.log_marginal_likelihood(ours.theta) > peer.log_marginal_likelihood_value_ - 2.0


@pytest.mark.parametrize("anchors", [60, 200])
def test_draws_are_spread_as_the_posterior_is(processes, anchors):
    drawn = draw(processes, count=400, waves=400, anchors=anchors, seed=1)
    queries = torch.linspace(-2.0, 2.0, 9)[:, None].expand(-1, 3)
    values = torch.stack([drawn(queries, torch.full((9,), number)) for number in range(400)])
    mean, deviation = processes.mean(queries.double()), processes.deviation(queries.double())
    # 400 draws: their mean errs by a twentieth of the deviation; the error of the waves, which all share, comes on top.
    assert float(((values.mean(0) - mean) / deviation).abs().max()) < 0.5
    torch.testing.assert_close(values.std(0).double(), deviation, rtol=0.25, atol=0)


def test_far_from_the_data_draws_are_those_of_the_prior(processes):
    drawn = draw(processes, count=400, waves=400, anchors=200, seed=1)
    far = torch.full((1, 3), 500.0)
    values = torch.cat([drawn(far, torch.tensor([number])) for number in range(400)])
    prior = processes.variance.sqrt() * processes.output_scale[1]
    torch.testing.assert_close(values.std(0).double(), prior, rtol=0.2, atol=0)


def test_a_draw_is_one_function_whoever_asks_and_whenever(processes):
    drawn = draw(processes, count=5, waves=64, anchors=50, seed=2)
    assert len(drawn) == 5
    queries, which = torch.randn(6, 3), torch.tensor([0, 1, 2, 3, 4, 0])
    together = drawn(queries, which)
    for place in range(6):
        alone = drawn(queries[place : place + 1], which[place : place + 1])
        torch.testing.assert_close(alone[0], together[place], rtol=1e-4, atol=1e-5)
    again = draw(processes, count=5, waves=64, anchors=50, seed=2)
    assert torch.equal(again(queries, which), together)
