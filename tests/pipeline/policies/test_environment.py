import torch

from tests.pipeline.policies.environment_contract import check_contract
from tests.pipeline.policies.point_mass import PointMass


def test_a_point_mass_keeps_to_the_contract():
    check_contract(PointMass(16), steps=100)


def test_an_action_beyond_its_bounds_counts_as_the_bound():
    first, second = PointMass(4), PointMass(4)
    first.start(0), second.start(0)
    beyond, bound = torch.full((4, 1), 7.0), torch.ones(4, 1)
    assert torch.equal(first.step(beyond).reached.policy, second.step(bound).reached.policy)


def test_a_machine_that_goes_too_far_ends_and_starts_anew():
    environment = PointMass(2)
    environment.start(0)
    environment.state["motion"] = torch.tensor([[3.9, 3.0], [0.0, 0.0]])
    transition = environment.step(torch.zeros(2, 1))
    assert transition.terminated.tolist() == [True, False]
    assert float(transition.reached.policy[0, 0]) > 4.0
    assert bool((transition.observation.policy[0].abs() <= 1.0).all())
    assert environment.state["age"].tolist() == [0, 1]


def test_another_seed_starts_elsewhere():
    environment = PointMass(8)
    first = environment.start(0).policy
    assert torch.equal(environment.start(0).policy, first)
    assert not torch.equal(environment.start(1).policy, first)
