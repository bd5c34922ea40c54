"""The processes against scikit-learn's, and against what the data were drawn from."""

import numpy as np
import pytest
import torch
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel

from simgap.policies.residual.gaussian_processes import fit
from simgap.policies.residual.realisations import draw
from simgap.policies.residual.wander import Course

NOISE = 0.1
ONE_FLIGHT = Course(torch.zeros(200, dtype=torch.long), 0.05 * torch.arange(200).double())


@pytest.fixture(scope="module")
def data():
    random = torch.Generator().manual_seed(0)
    features = torch.rand(200, 3, generator=random, dtype=torch.float64) * 4.0 - 2.0
    truth = torch.stack([torch.sin(2.0 * features[:, 0]), 0.5 * features[:, 1] ** 2 + 3.0], 1)
    return features, truth + NOISE * torch.randn(truth.shape, generator=random, dtype=torch.float64), truth


@pytest.fixture(scope="module")
def processes(data):
    return fit(data[0], data[1], ONE_FLIGHT, judged_by=200, iterations=80)


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
    kernel = ConstantKernel(1.0, (0.01, 1.0)) * RBF([1.0] * 3, (0.1, 30.0)) + WhiteKernel(0.1, (1e-3, 1.5))
    peer = GaussianProcessRegressor(kernel, random_state=0)
    peer.fit(processes.inputs.numpy(), processes.outputs[0].numpy())
    ours = ConstantKernel(float(processes.variance[0])) * RBF(processes.lengths[0].numpy())
    ours += WhiteKernel(float(processes.noise[0]))
    assert peer.log_marginal_likelihood(ours.theta) > peer.log_marginal_likelihood_value_ - 2.0


@pytest.mark.parametrize("anchors", [60, 200])
def test_draws_are_spread_as_the_posterior_is(processes, anchors):
    drawn = draw(processes, count=400, waves=400, anchors=anchors, seed=1)
    queries = torch.linspace(-2.0, 2.0, 9)[:, None].expand(-1, 3)
    values = torch.stack([drawn(queries, torch.zeros(9), torch.full((9,), number)) for number in range(400)])
    mean, deviation = processes.mean(queries.double()), processes.deviation(queries.double())
    # 400 draws: their mean errs by a twentieth of the deviation; the error of the waves, which all share, comes on top.
    assert float(((values.mean(0) - mean) / deviation).abs().max()) < 0.5
    torch.testing.assert_close(values.std(0).double(), deviation, rtol=0.25, atol=0)


def test_far_from_the_data_draws_are_those_of_the_prior(processes):
    drawn = draw(processes, count=400, waves=400, anchors=200, seed=1)
    far = torch.full((1, 3), 500.0)
    values = torch.cat([drawn(far, torch.zeros(1), torch.tensor([number])) for number in range(400)])
    prior = processes.variance.sqrt() * processes.output_scale[1]
    torch.testing.assert_close(values.std(0).double(), prior, rtol=0.2, atol=0)


def test_a_draw_is_one_function_whoever_asks_and_whenever(processes):
    drawn = draw(processes, count=5, waves=64, anchors=50, seed=2)
    assert len(drawn) == 5
    asked = torch.randn(6, 3), torch.rand(6), torch.tensor([0, 1, 2, 3, 4, 0])
    together = drawn(*asked)
    for place in range(6):
        alone = drawn(*(part[place : place + 1] for part in asked))
        torch.testing.assert_close(alone[0], together[place], rtol=1e-4, atol=1e-5)
    again = draw(processes, count=5, waves=64, anchors=50, seed=2)
    assert torch.equal(again(*asked), together)


FLIGHTS, SAMPLES, STEP, LASTS, SIZE = 6, 100, 0.1, 0.6, 0.5


@pytest.fixture(scope="module")
def wandering():
    """Flights through the same states, each with a drift of its own; noise alone in the second residual."""
    random = torch.Generator().manual_seed(1)
    moment = STEP * torch.arange(SAMPLES).double()
    apart = (moment[:, None] - moment) / LASTS
    factor = torch.linalg.cholesky(torch.exp(-0.5 * apart.square()) + 1e-8 * torch.eye(SAMPLES))
    drift = factor @ torch.randn(SAMPLES, FLIGHTS, generator=random, dtype=torch.float64)
    course = Course(torch.arange(FLIGHTS).repeat_interleave(SAMPLES), moment.repeat(FLIGHTS))
    features = 4.0 * torch.rand(FLIGHTS * SAMPLES, 2, generator=random, dtype=torch.float64) - 2.0
    repeated = torch.sin(2.0 * features)
    noise = 0.1 * torch.randn(repeated.shape, generator=random, dtype=torch.float64)
    drifting = torch.stack([SIZE * drift.T.flatten(), torch.zeros(len(features))], 1)
    return fit(features, repeated + noise + drifting, course, judged_by=300, iterations=60)


def test_what_no_other_flight_foretells_is_drawn_anew_in_each(wandering):
    """The drift has some 100 independent values: its size is known to a tenth, and 100 draws of it to as much."""
    drawn = draw(wandering, count=400, waves=256, anchors=100, seed=0)
    still, which = torch.zeros(400, 2), torch.arange(400)
    later = [drawn(still, torch.full((400,), moment), which) for moment in (3.0, 3.0 + LASTS, 9.0)]
    apart = later[0][:, 0] - later[2][:, 0]
    assert float(apart.std()) == pytest.approx(2.0**0.5 * _told(wandering), rel=0.15)
    together = torch.corrcoef(torch.stack([part[:, 0] for part in later]))
    assert 0.3 < float(together[0, 1]) < 0.9
    unchanged = (later[0] - later[2])[:, 1].std() / later[0][:, 1].std()
    assert float(unchanged) < 0.5


def _told(processes):
    return float(processes.wander.variance[0].sqrt() * processes.output_scale[1, 0])


def test_how_much_wanders_and_for_how_long_is_found(wandering):
    """Noise takes a part of the drift where samples lie as far apart as it lasts: half is not to be lost."""
    assert 0.5 * SIZE < _told(wandering) < 1.3 * SIZE
    assert 0.5 * LASTS < float(wandering.wander.time[0]) < 2.0 * LASTS
    assert float(wandering.wander.variance[1]) < 0.02


def test_one_flight_says_nothing_about_what_wanders(processes):
    assert processes.wander.variance.tolist() == [0.0, 0.0]
