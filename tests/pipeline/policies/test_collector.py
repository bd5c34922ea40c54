import torch

from simgap.policies.collector import Collector
from simgap.policies.networks import Critic, Gaussian
from tests.pipeline.policies.point_mass import PointMass


def networks() -> tuple[Gaussian, Critic]:
    torch.manual_seed(0)
    return Gaussian(2, 1, [8], 0.2, 0.5), Critic(2, 1, [8], 0.2)


def collected(horizon: int):
    gaussian, critic = networks()
    collector = Collector(PointMass(6), seed=1)
    return collector, critic, collector.collect(gaussian, critic, horizon, torch.Generator().manual_seed(0))


def test_a_density_is_that_of_the_normal_distribution():
    gaussian, _ = networks()
    observation = torch.randn(5, 2)
    action, density = gaussian.sample(observation, torch.Generator().manual_seed(0))
    expected = torch.distributions.Normal(*gaussian(observation)).log_prob(action).sum(-1)
    torch.testing.assert_close(density, expected)


def test_what_follows_a_step_is_valued_by_what_was_reached_even_where_the_episode_was_cut_off():
    collector, critic, segment = collected(horizon=90)  # episodes are cut off after 40 steps
    steps = segment.steps
    cut = steps["done"] & ~steps["terminated"]
    assert int(cut.sum()) >= 6
    inner = ~steps["done"][:-1]
    assert torch.equal(steps["next_value"][:-1][inner], steps["value"][1:][inner])
    assert not torch.equal(steps["next_value"][:-1][cut[:-1]], steps["value"][1:][cut[:-1]])
    with torch.no_grad():
        last = critic(collector.observation.policy, collector.observation.privileged)
    assert torch.equal(steps["next_value"][-1][~steps["done"][-1]], last[~steps["done"][-1]])


def test_returns_are_those_of_whole_episodes_across_segments():
    gaussian, critic = networks()
    collector, generator = Collector(PointMass(6), seed=1), torch.Generator().manual_seed(0)
    segments = [collector.collect(gaussian, critic, 25, generator) for _ in range(2)]
    rewards = torch.cat([segment.steps["reward"] for segment in segments])[..., 0]
    assert "return" not in segments[0].measures
    assert segments[1].measures["episodes"] == 6.0
    whole = float(rewards[:40].sum(0).mean())
    assert abs(segments[1].measures["return"] - whole) < 1e-5
