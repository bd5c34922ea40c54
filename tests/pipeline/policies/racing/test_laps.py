import math

import pytest
import torch

from simgap.policies.racing.flying import PARTS
from simgap.policies.racing.laps import Laps, fly_laps
from simgap.policies.racing.settings import RacingSettings, Starts
from tests.pipeline.policies.racing.machines import COARSE, racing

STILL = Starts(position=0.0, velocity=0.0, attitude=0.0, body_rate=0.0, speed=0.0)


class Carried:
    """Carries all machines around the ring of the tiny track at a constant speed, whatever is commanded."""

    def __init__(self, environment, speed: float, radius: float = 4.0) -> None:
        self.environment, self.turned = environment, -0.5 * math.pi
        self.speed, self.radius = speed, radius

    def __call__(self, observation) -> torch.Tensor:
        x, y = math.cos(self.turned), math.sin(self.turned)
        rows = self.environment.state["rows"]
        rows[PARTS["position"]] = torch.tensor([self.radius * x, self.radius * y, 2.5])[:, None]
        rows[PARTS["velocity"]] = torch.tensor([-self.speed * y, self.speed * x, 0.0])[:, None]
        self.turned += self.speed / self.radius * self.environment.period
        return torch.zeros(self.environment.batch, 4)


@pytest.fixture(scope="module")
def environment():
    return racing(3, settings=RacingSettings(flying=COARSE, starts=STILL))


@pytest.mark.slow
def test_laps_at_a_constant_speed_take_the_time_of_the_circle(environment):
    laps = fly_laps(environment, Carried(environment, speed=8.0), seed=0, laps=2, seconds=30.0)
    expected = 2.0 * math.pi * 4.0 / 8.0
    assert laps.times.shape == (3, 2)
    torch.testing.assert_close(laps.times, torch.full((3, 2), expected), atol=0.02, rtol=0.0)
    assert laps.passed.tolist() == [9, 9, 9]
    metrics = laps.metrics()
    assert metrics["completed"] == metrics["laps_completed"] == 1.0
    assert metrics["fastest_lap"] == pytest.approx(expected, abs=0.02)
    assert metrics["least_margin"] == pytest.approx(1.5, abs=0.05)


@pytest.mark.slow
def test_a_race_goes_on_beyond_the_episodes_of_the_training():
    short = racing(2, settings=RacingSettings(flying=COARSE, starts=STILL, episode_steps=50))
    laps = fly_laps(short, Carried(short, speed=8.0), seed=0, laps=2, seconds=30.0)
    assert laps.passed.tolist() == [9, 9]
    steps = laps.states[:, 0, PARTS["position"]].diff(dim=0).norm(dim=-1)
    assert float(steps.max()) < 0.2  # 8 m/s, and nobody is put elsewhere


@pytest.mark.slow
def test_a_lap_with_a_crash_is_no_lap(environment):
    laps = fly_laps(environment, Carried(environment, speed=8.0, radius=5.7), seed=0, seconds=5.0)
    assert laps.passed.tolist() == [0, 0, 0]
    assert not bool(laps.times.isfinite().any())
    assert laps.metrics() == {"completed": 0.0, "laps_completed": 0.0}
    assert bool(laps.states[-1].isfinite().all())  # all ended with the same step


def test_the_fastest_machine_is_that_of_the_fastest_lap_or_the_one_that_came_furthest():
    nan = math.nan
    flown = {
        "margins": torch.zeros(0),
        "passed": torch.tensor([9, 5, 9]),
        "gates": 9,
        "states": torch.zeros(0),
    }
    times = torch.tensor([[3.0, 2.5], [2.2, nan], [2.4, 2.6]])
    assert Laps(times=times, **flown).fastest == 1
    assert Laps(times=torch.full((3, 2), nan), **{**flown, "passed": torch.tensor([1, 3, 2])}).fastest == 1


def test_flights_follow_the_seed(environment):
    perturbing = racing(4)
    first, again, other = (
        fly_laps(perturbing, lambda seen: torch.zeros(4, 4), seed, seconds=0.3) for seed in (0, 0, 1)
    )
    assert torch.equal(first.states, again.states)
    assert not torch.equal(first.states, other.states)
    assert float((first.states[0, 1:] - first.states[0, :1]).abs().max()) > 0.0
