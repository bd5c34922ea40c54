import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from simgap.equations.fit import Fit, clustered_covariance, inverse_of
from simgap.equations.scoring import (
    ENOUGH_CLUSTERS,
    clusters_of,
    cross_validated,
    folds_of,
    independent_clusters,
    log_score,
)
from simgap.simulation.blocks import Blocks
from tests.pipeline.gap.problems import random_like
from tests.pipeline.gap.recordings import joint_simulator


def _blocks(run: list[int], start: list[float]) -> Blocks:
    names = tuple(f"run_{index}" for index in range(max(run) + 1))
    return Blocks({}, torch.tensor(run), names, torch.tensor(start, dtype=torch.float64), 0.01, 0, 100)


runs = st.lists(st.integers(0, 7), min_size=1, max_size=60)


@given(runs, st.integers(2, 6))
def test_a_run_is_never_divided_between_folds(run, count):
    fold = folds_of(_blocks(run, list(range(len(run)))), count)
    lengths = [run.count(name) for name in set(run)]
    if len(lengths) > 2 or (len(lengths) == 2 and max(lengths) < 2 * min(lengths)):
        for name in set(run):
            assert len(set(fold[torch.tensor(run) == name].tolist())) == 1
        assert len(fold.unique()) == min(count, len(set(run)))


@pytest.mark.parametrize("run", [[0] * 10, [0] * 8 + [1] * 2])
def test_one_run_or_a_long_and_a_short_one_are_cut_into_stretches_of_time(run):
    fold = folds_of(_blocks(run, list(range(10))), 5)
    assert fold.tolist() == [0, 0, 1, 1, 2, 2, 3, 3, 4, 4]


@given(runs, st.floats(0.5, 20.0))
def test_a_cluster_never_crosses_runs_nor_outlasts_its_duration(run, duration):
    start = [float(index) for index in range(len(run))]
    blocks = _blocks(run, start)
    cluster = clusters_of(blocks, duration)
    assert set(cluster.tolist()) == set(range(int(cluster.max()) + 1))
    for number in cluster.unique():
        mine = cluster == number
        assert len(blocks.run[mine].unique()) == 1
        assert float(blocks.start[mine].max() - blocks.start[mine].min()) < duration


@given(st.integers(1, 400), st.integers(1, 6))
def test_short_recordings_have_as_many_clusters_as_their_blocks_allow(count, run_count):
    run = [index * run_count // count for index in range(count)]
    clusters = int(independent_clusters(_blocks(run, [float(index) for index in range(count)])).max()) + 1
    assert min(count, ENOUGH_CLUSTERS) <= clusters <= max(ENOUGH_CLUSTERS, count / 3) + len(set(run)) + 1


def _linear(seed: int) -> tuple[Fit, torch.Tensor]:
    """Return a least-squares fit of a linear model on 6 runs of 5 blocks, and its targets."""
    jacobian, noise = random_like((30, 4, 2, 3), seed), random_like((30, 4, 2), seed + 1)
    truth = torch.tensor([1.0, -2.0, 0.5], dtype=torch.float64)
    scale = torch.tensor([1.0, 2.0], dtype=torch.float64)
    target = jacobian @ truth + noise * scale
    values = _least_squares(jacobian, target, scale)
    return Fit(joint_simulator(), target - jacobian @ values, jacobian, scale, torch.eye(3).double()), target


def _least_squares(jacobian, target, scale):
    weighted = (jacobian / scale[:, None]).reshape(-1, 3)
    return torch.linalg.lstsq(weighted, (target / scale).reshape(-1, 1)).solution[:, 0]


@pytest.mark.parametrize("seed", [0, 10, 20])
def test_cross_validation_equals_fitting_again_without_the_fold(seed):
    found, target = _linear(seed)
    fold = folds_of(_blocks([b // 5 for b in range(30)], list(range(30))), 3)
    out = cross_validated(found, fold)
    for left_out in fold.unique():
        kept, mine = fold != left_out, fold == left_out
        values = _least_squares(found.jacobian[kept], target[kept], found.scale)
        torch.testing.assert_close(out[mine], target[mine] - found.jacobian[mine] @ values)


def test_without_parameters_cross_validation_changes_nothing():
    found, _ = _linear(0)
    bare = Fit(
        joint_simulator(), found.residual, found.jacobian[..., :0], found.scale, torch.zeros(0, 0).double()
    )
    assert torch.equal(cross_validated(bare, torch.zeros(30, dtype=torch.long)), found.residual)


def test_the_log_score_is_a_gaussian_likelihood():
    residual, scale = random_like((5, 4, 2), 3), torch.tensor([0.5, 3.0], dtype=torch.float64)
    exact = torch.distributions.Normal(0.0, scale).log_prob(residual)
    constant = 0.5 * torch.log(torch.tensor(2.0 * torch.pi)) * 4 * 2
    torch.testing.assert_close(log_score(residual, scale) - constant.double(), exact.sum((1, 2)))


@given(st.lists(st.floats(-12.0, 12.0), min_size=3, max_size=3))
def test_what_is_known_of_a_parameter_does_not_depend_on_units(decades):
    """A rotor's inertia in kg·m² stands beside a drag in 1/s."""
    fit, _ = _linear(0)
    unit = 10.0 ** torch.tensor(decades, dtype=torch.float64)
    other = Fit(fit.simulator, fit.residual, fit.jacobian / unit, fit.scale, fit.covariance)
    fold = torch.arange(30) // 6
    torch.testing.assert_close(cross_validated(other, fold), cross_validated(fit, fold), rtol=1e-6, atol=1e-9)
    before, after = (clustered_covariance(f.jacobian, f.residual, f.scale, fold) for f in (fit, other))
    torch.testing.assert_close(after / unit / unit[:, None], before, rtol=1e-6, atol=1e-12)
    torch.testing.assert_close(
        inverse_of(after) * unit * unit[:, None], inverse_of(before), rtol=1e-3, atol=1e-6
    )
