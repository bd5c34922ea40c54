import pytest
import torch

from simgap.policies.best import Best
from simgap.policies.networks import Gaussian
from simgap.policies.settings import Learning
from simgap.policies.training import Training
from tests.pipeline.policies.point_mass import PointMass

LEARNING = Learning(
    interactions=30_000, machines=64, horizon=16, minibatch=256, hidden=[16], checkpoint_every=4
)


class Judge:
    """Tells costs one after the other, and remembers whom it judged."""

    def __init__(self, *costs: float) -> None:
        self.costs, self.judged = list(costs), []

    def __call__(self, gaussian: Gaussian) -> float:
        self.judged.append(gaussian.log_deviation.detach().clone())
        return self.costs[len(self.judged) - 1]


def _gaussian(deviation: float) -> Gaussian:
    return Gaussian(2, 1, [4], 0.2, deviation)


@pytest.mark.parametrize(
    ("costs", "kept"),
    [
        ([3.0, 1.0, 2.0], 1),
        ([1.0, 1.0, 2.0], 1),
        ([float("nan"), 5.0, float("nan")], 1),
        ([2.0, 3.0, 1.0], 2),
    ],
)
def test_the_cheapest_is_kept_and_of_equals_the_later(costs, kept):
    best, policies = Best(Judge(*costs)), [_gaussian(0.1 + number) for number in range(3)]
    for policy in policies:
        best.consider(policy)
    last = _gaussian(9.0)
    best.restore(last)
    assert all(map(torch.equal, last.parameters(), policies[kept].parameters()))


def test_the_sequence_of_the_best_has_each_at_its_cost():
    costs = [float("nan"), 3.0, 4.0, 2.0, 2.0, 1.0]
    best, policies = Best(Judge(*costs)), [_gaussian(0.1 + number) for number in range(6)]
    for policy in policies:
        best.consider(policy)
    assert best.costs == [3.0, 2.0, 1.0]
    for number, kept in enumerate([1, 4, 5]):
        best.restore(policies[0], number)
        assert all(map(torch.equal, policies[0].parameters(), policies[kept].parameters()))


def test_where_none_is_of_use_the_last_stays():
    best, last = Best(Judge(float("nan"))), _gaussian(0.5)
    best.consider(last)
    best.restore(last)
    assert last.log_deviation.exp().item() == pytest.approx(0.5)


def test_a_training_ends_with_its_best_policy_also_where_it_was_stopped_between(tmp_path):
    updates = Training(PointMass(64), LEARNING, 3).updates
    costs = [2.0, 1.0, *[3.0] * updates]
    judge = Judge(*costs)
    whole = Training(PointMass(64), LEARNING, 3, Best(judge))
    whole.run(tmp_path / "whole")
    assert len(judge.judged) == updates // LEARNING.checkpoint_every + 1
    assert torch.equal(whole.learner.gaussian.log_deviation, judge.judged[1])

    stopped = Training(PointMass(64), LEARNING, 3, Best(Judge(*costs)))
    with pytest.raises(InterruptedError):
        stopped.run(tmp_path / "stopped", _stop_after(3 * LEARNING.checkpoint_every + 1))
    rest = Judge(*costs[3:])
    resumed = Training(PointMass(64), LEARNING, 3, Best(rest))
    resumed.run(tmp_path / "stopped")
    assert len(rest.judged) == len(judge.judged) - 3
    assert all(map(torch.equal, resumed.learner.gaussian.parameters(), whole.learner.gaussian.parameters()))


def test_who_judges_changes_nothing_in_what_is_learnt():
    plain = Training(PointMass(64), LEARNING, 3)
    judged = Training(PointMass(64), LEARNING, 3, Best(lambda gaussian: 1.0))
    assert plain.run() == judged.run()
    assert all(map(torch.equal, plain.learner.gaussian.parameters(), judged.learner.gaussian.parameters()))


def _stop_after(number: int):
    def log(entry: dict[str, float], update: int) -> None:
        if update == number:
            raise InterruptedError

    return log
