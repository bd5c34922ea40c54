"""How much rows count: noise one by one, a discrepancy by its few independent samples."""

import math

import numpy as np
import pytest
import scipy.stats
import torch

from simgap.equations.row_noise import TOLERATED
from simgap.equations.temper import Mixture, Temper, energy_of, temper_of
from simgap.gap.settings import Gap
from tests.pipeline.gap.problems import problem_of, random_like
from tests.pipeline.gap.recordings import Plant, joint_recording, joint_simulator

BLOCKS = 40
TEMPER = Temper(rows=9, lasting=0.2, short=4.3)
NOISE = torch.tensor([0.01, 25.0], dtype=torch.float64)


def left_of(*ratios: float, blocks: int = BLOCKS) -> torch.Tensor:
    """Return mean squares that are so many times the noise: of these first blocks, and once of all others."""
    ratio = torch.ones(blocks, dtype=torch.float64)
    ratio[: len(ratios)] = torch.tensor(ratios, dtype=torch.float64)
    return ratio[:, None] * NOISE


def spread_of(seed: int) -> torch.Tensor:
    """Return mean squares from once to ten thousand times the noise."""
    return NOISE * (1.0 + random_like((BLOCKS, 2), seed).mul(3.0).exp())


@pytest.mark.parametrize("seed", range(5))
def test_the_likelihood_falls_as_the_residual_grows(seed):
    left = spread_of(seed)
    values = torch.stack(
        [TEMPER.value(NOISE + grown * (left - NOISE), NOISE) for grown in (1.0, 1.5, 2.0, 9.0)]
    )
    assert (values.diff(dim=0) < 0).all()


@pytest.mark.parametrize("block", [0, 7])
@pytest.mark.parametrize("others", [1.0, 300.0])
def test_it_falls_for_one_block_as_for_all(block, others):
    values = []
    for ratio in (1.0, 1.3, 2.0, 5.0, 30.0, 1e3, 1e6):
        left = left_of(*[others] * BLOCKS)
        left[block] = ratio * NOISE
        values.append(TEMPER.value(left, NOISE))
    assert (torch.stack(values).diff(dim=0) < 0).all()


def test_blocks_of_as_much_as_noise_differ_by_the_measure_only():
    """Whatever the noise is: it enters through the independent samples of a discrepancy only."""
    value = TEMPER.value(left_of(), NOISE)
    measure = BLOCKS * (TEMPER.by_chance(TOLERATED) - 0.5 * TEMPER.lasting * NOISE.log())
    assert (value - measure).abs().max() < 1e-3 * BLOCKS
    torch.testing.assert_close(
        TEMPER.weight(left_of(), NOISE) * NOISE * TEMPER.rows,
        TEMPER.total * torch.ones(BLOCKS, 2).double(),
        rtol=1e-3,
        atol=0.0,
    )


@pytest.mark.parametrize("independent", [2, 10, 100])
def test_drawn_noise_costs_nothing_on_average(independent):
    """The noise is an estimate with an allowance, and what is below it counts as it: within four standard errors."""
    blocks, temper = 20_000, Temper(2 * independent, 0.1, independent - 0.1)
    drawn = np.random.default_rng(independent).chisquare(independent, blocks) / independent / TOLERATED
    left = torch.from_numpy(np.maximum(drawn, 1.0))[:, None]
    mixture = Mixture(torch.full((1, 1), 1e-12).double(), torch.full((1, 1), 1e-9).double())
    noise = torch.ones(1, dtype=torch.float64)
    costs = 0.5 * independent * (left - 1.0)
    error = float(costs.std()) / math.sqrt(blocks)
    assert float(temper.value_of(mixture, left, noise)) / blocks == pytest.approx(0.0, abs=4.0 * error)


def test_a_recording_in_smaller_units_is_as_probable_up_to_the_measure():
    left, unit = spread_of(3), 1e3
    moved = TEMPER.value(unit**2 * left, unit**2 * NOISE) - TEMPER.value(left, NOISE)
    torch.testing.assert_close(moved, torch.full((2,), -TEMPER.lasting * BLOCKS * math.log(unit)).double())


def test_what_one_block_costs_is_bounded_where_most_hold_a_discrepancy():
    """Of a million times the noise it costs a few independent samples, not thousands."""
    most = [100.0] * (BLOCKS - 1)
    costs = [
        TEMPER.value(left_of(*most, 1.0), NOISE) - TEMPER.value(left_of(*most, r), NOISE) for r in (1e2, 1e6)
    ]
    tail = 0.5 * TEMPER.lasting * 1.8 * math.log((0.8 + 1e4) / 1.8)  # Student's t with 0.8 degrees of freedom
    assert (costs[1] - costs[0]).max() == pytest.approx(tail, rel=0.1)
    assert costs[1].max() < 0.5 * TEMPER.lasting * 1.8 * math.log(1e4 / 0.8) + 0.1


def test_a_block_that_is_missed_counts_more_where_all_others_are_met():
    """There it is more likely a fault of the hypothesis than of the machine."""
    among_good = TEMPER.value(left_of(), NOISE) - TEMPER.value(left_of(1e4), NOISE)
    bad = [1e4] * (BLOCKS - 1)
    among_bad = TEMPER.value(left_of(*bad, 1.0), NOISE) - TEMPER.value(left_of(*bad, 1e4), NOISE)
    assert (among_good > among_bad + 2.0).all()


@pytest.mark.parametrize("seed", range(5))
def test_the_weight_is_the_slope_of_the_likelihood(seed):
    """A row's residual r counts −dℓ/dr / r: with a mean square of n rows, −2/n · dℓ/d(mean square)."""
    left = spread_of(seed).requires_grad_()
    mixture, weight = TEMPER.mixture(left.detach(), NOISE), TEMPER.weight(left.detach(), NOISE)
    (slope,) = torch.autograd.grad(TEMPER.value_of(mixture, left, NOISE).sum(), left)
    torch.testing.assert_close(weight, -2.0 / TEMPER.rows * slope)
    # The likeliest mixture moves with the residual and changes nothing, but for the end of its iteration.
    (whole,) = torch.autograd.grad(TEMPER.value(left, NOISE).sum(), left)
    torch.testing.assert_close(weight, -2.0 / TEMPER.rows * whole, rtol=1e-3, atol=1e-3)


@pytest.mark.parametrize("seed", range(3))
def test_the_order_of_blocks_does_not_matter(seed):
    left, order = spread_of(seed), torch.randperm(BLOCKS, generator=torch.Generator().manual_seed(seed))
    torch.testing.assert_close(TEMPER.value(left[order], NOISE), TEMPER.value(left, NOISE))
    torch.testing.assert_close(TEMPER.weight(left[order], NOISE), TEMPER.weight(left, NOISE)[order])


def test_channels_count_apart():
    left, other = spread_of(0), spread_of(1)
    both = torch.stack([left[:, 0], other[:, 1]], dim=1)
    assert float(TEMPER.value(both, NOISE)[0]) == pytest.approx(float(TEMPER.value(left, NOISE)[0]))


def test_the_energy_is_never_below_the_least():
    residual = torch.zeros(3, 5, 2, dtype=torch.float64)
    residual[1] = 2.0
    least = torch.tensor([1.0, 9.0], dtype=torch.float64)
    assert energy_of(residual, least).tolist() == [[1.0, 9.0], [4.0, 9.0], [1.0, 9.0]]


def test_independent_samples_are_fewer_than_rows_and_saturate_with_time():
    """A discrepancy is a function of the state: a longer recording repeats it."""
    totals = []
    for runs in (1, 3, 12):
        problem = problem_of(joint_recording(Plant(), runs=runs), joint_simulator())
        temper = temper_of(problem.blocks, problem.functions, Gap().test_width)
        assert temper.rows == len(problem.functions.centres)
        assert temper.total == pytest.approx(0.5 * temper.rows)
        totals.append(temper.lasting * len(problem.blocks))
    assert totals[0] < totals[1] < totals[2] < 16.0


def test_a_block_counts_once_where_only_inexact_laws_are_left_in_it():
    zero = torch.zeros(1, 1, dtype=torch.float64)
    noise = torch.ones(1, 1, dtype=torch.float64)
    assert float(TEMPER.beside(noise, zero).total) == pytest.approx(TEMPER.total)
    assert float(TEMPER.beside(1e-12 * noise, noise).total) == pytest.approx(max(TEMPER.lasting, 1.0))


def test_rows_count_no_more_than_both_sources_and_no_less_than_one():
    """Satterthwaite's number lies between the smaller one and the sum."""
    inexact = torch.logspace(-3, 3, 13, dtype=torch.float64)[:, None]
    counts = TEMPER.beside(torch.ones(1, dtype=torch.float64), inexact).total
    assert (counts >= TEMPER.lasting).all()
    assert (counts <= TEMPER.total + max(TEMPER.lasting, 1.0)).all()
    assert (
        counts.diff(dim=0)[5:] < 0.0
    ).all()  # once the inexact part is a third of the noise, it lowers the count


@pytest.mark.parametrize("independent", [1.5, 4.5, 40.0])
@pytest.mark.parametrize("tolerated", [1.0, 1.2])
def test_what_noise_costs_by_chance_is_the_mean_of_what_it_costs(independent, tolerated):
    """A million drawn blocks; the tolerance is five standard errors."""
    temper = Temper(rows=9, lasting=0.2, short=independent - 0.2)
    drawn = torch.distributions.Chi2(torch.tensor(independent, dtype=torch.float64))
    torch.manual_seed(0)
    energy = drawn.sample((1_000_000,)) / independent / tolerated
    costs = 0.5 * independent * (energy - 1.0).clamp_min(0.0)
    error = 5.0 * float(costs.std()) / 1000.0
    assert float(temper.by_chance(tolerated)) == pytest.approx(float(costs.mean()), abs=error)


def test_a_sample_seen_in_one_row_has_the_density_of_noise_or_of_t():
    """Up to what noise costs on average: log of the density at one standard deviation.

    Beside the discrepancy the noise counts with what its mean square may be off by chance: of one row, by √2.
    """
    temper = Temper(rows=2, lasting=1.0, short=0.0)
    left, noise, usual, share = spread_of(1), NOISE, torch.tensor([[0.3, 2.0]], dtype=torch.float64), 0.3
    mixture = Mixture(torch.full((1, 2), share, dtype=torch.float64), usual)
    expected = (1.0 + math.sqrt(2.0)) * noise + usual
    beside = scipy.stats.t.logpdf((left / expected).sqrt(), 0.8) - 0.5 * expected.log().numpy()
    alone = scipy.stats.norm.logpdf((left / noise).sqrt()) - 0.5 * noise.log().numpy()
    alone = alone + float(temper.by_chance(TOLERATED))
    densities = np.log(share * np.exp(beside) + (1.0 - share) * np.exp(alone)).sum(0)
    costs = 0.5 * BLOCKS * math.log(2.0 * math.pi * math.e)
    prior = -share / 0.2  # exponential, a fifth on average
    torch.testing.assert_close(
        temper.value_of(mixture, left, noise), torch.from_numpy(densities + costs + prior)
    )


@pytest.mark.parametrize("share", [1.0, 0.2])
@pytest.mark.parametrize("repeats", [2, 5, 20])
def test_a_discrepancy_has_the_evidence_of_a_constant_that_is_seen_in_several_rows(repeats, share):
    """The Gaussian evidence of rows δ + e: that of t differs from it by what a wide spread of sizes costs.

    A discrepancy that is in a fifth of the blocks has all its samples there, one in each.
    """
    noise, usual = 0.001, 3.0
    temper = Temper(rows=2 * repeats, lasting=share, short=repeats - share)
    covariance = noise * np.eye(repeats) + usual
    values, exact = [], []
    for size in (1.0, 3.0, 9.0):
        rows = size * np.ones(repeats) + math.sqrt(noise) * _standard(repeats)
        left = torch.tensor([[np.square(rows).mean()]], dtype=torch.float64)
        mixture = Mixture(
            torch.full((1, 1), min(share, 1.0 - 1e-12)).double(), torch.full((1, 1), usual).double()
        )
        least = torch.full((1, 1), noise, dtype=torch.float64)
        values.append(float(temper.value_of(mixture, left, least)))
        exact.append(scipy.stats.multivariate_normal.logpdf(rows, cov=covariance))
    # With t in the place of the Gaussian: the sample is the sum of the rows over the root of their number.
    size = noise + repeats * usual
    samples = np.array([repeats * each**2 + noise for each in (1.0, 3.0, 9.0)]) / size
    swapped = scipy.stats.t.logpdf(np.sqrt(samples), 0.8) - scipy.stats.norm.logpdf(np.sqrt(samples))
    np.testing.assert_allclose(np.diff(values), np.diff(exact + swapped), atol=0.02)


@pytest.mark.parametrize(("share", "samples"), [(0.01, 1.0), (0.1, 1.0), (0.2, 0.5), (0.5, 0.2), (1.0, 0.1)])
def test_a_discrepancy_has_as_many_samples_however_few_blocks_it_is_in(share, samples):
    temper = Temper(rows=20, lasting=0.1, short=9.9)
    assert float(temper.samples(torch.tensor(share))) == pytest.approx(samples)


def test_a_long_block_has_all_its_samples_whatever_the_share():
    temper = Temper(rows=20, lasting=3.0, short=7.0)
    assert temper.samples(torch.tensor([0.01, 0.5, 1.0])).tolist() == [3.0, 3.0, 3.0]


def _standard(rows: int) -> np.ndarray:
    """Return rows of mean zero whose squares sum to their number."""
    wave = np.resize([1.0, -1.0], rows)
    wave = wave - wave.mean()
    return wave * math.sqrt(rows / np.square(wave).sum())


@pytest.mark.parametrize("seed", range(6))
def test_no_other_share_and_no_other_size_is_likelier(seed):
    temper, noise = Temper(20, 0.7, 8.0), torch.tensor([1.0, 1e-4], dtype=torch.float64)
    left = torch.maximum(noise * spread_of(seed)[:, :1], noise)
    found = temper.mixture(left, noise)
    best = temper.value_of(found, left, noise)
    for share in (found.share, *(torch.full_like(found.share, each) for each in (0.01, 0.2, 0.6, 0.95))):
        for scale in (1e-3, 0.1, 0.5, 0.9, 1.0, 1.1, 2.0, 10.0, 1e3):
            other = temper.value_of(Mixture(share, scale * found.usual), left, noise)
            assert torch.all(other <= best + 0.05)


def test_mixtures_of_many_recordings_are_those_of_each():
    temper, noise = Temper(20, 0.7, 8.0), torch.ones(1, dtype=torch.float64)
    each = [torch.maximum(spread_of(seed)[:, :1], noise) for seed in range(4)]
    together = temper.mixture(torch.stack(each), noise)
    alone = [temper.mixture(left, noise) for left in each]
    torch.testing.assert_close(together.share, torch.stack([one.share for one in alone]))
    torch.testing.assert_close(together.usual, torch.stack([one.usual for one in alone]))
