import math
from itertools import pairwise

import pytest
import torch

from simgap.physics import rotations
from simgap.policies.racing.reward import racing_reward, reward_at, viewing_angle
from simgap.policies.racing.settings import Reward

LEVEL = torch.tensor([[1.0, 0.0, 0.0, 0.0]])
HOVER = torch.tensor([[9.81, 0.0, 0.0, 0.0]])
GATE = torch.tensor([[10.0, 0.0, 0.0]])
NOTHING = Reward(progress=0.0, perception=0.0, rates=0.0, change=0.0, crash=0.0)


def reward(
    settings: Reward, before=(0.0, 0.0, 0.0), after=(0.0, 0.0, 0.0), command=HOVER, crashed=False
) -> float:
    state = {"position": torch.tensor([after]), "attitude": LEVEL}
    given = (torch.tensor([before]), state, GATE, command, HOVER, torch.tensor([crashed]))
    return float(racing_reward(settings, *given, torch.tensor(settings.crash)))


def test_progress_is_the_way_by_which_the_gate_comes_nearer():
    settings = Reward(**{**vars(NOTHING), "progress": 2.0})
    assert reward(settings, (0.0, 0.0, 0.0), (0.3, 0.0, 0.0)) == pytest.approx(0.6, abs=1e-5)
    assert reward(settings, (10.0, 3.0, 0.0), (10.0, -3.0, 0.0)) == pytest.approx(0.0, abs=1e-5)


def test_progress_along_a_way_does_not_depend_on_its_steps():
    settings = Reward(**{**vars(NOTHING), "progress": 1.0})
    points = torch.randn(20, 3, generator=torch.Generator().manual_seed(0)).tolist()
    total = sum(reward(settings, a, b) for a, b in pairwise(points))
    assert total == pytest.approx(math.dist(points[0], GATE[0]) - math.dist(points[-1], GATE[0]), abs=1e-4)


def test_each_term_has_its_weight():
    turning = torch.tensor([[9.81, 3.0, 0.0, 4.0]])
    assert reward(Reward(**{**vars(NOTHING), "rates": -0.5}), command=turning) == pytest.approx(-2.5)
    assert reward(Reward(**{**vars(NOTHING), "change": -0.1}), command=turning) == pytest.approx(-2.5)
    assert reward(Reward(**{**vars(NOTHING), "crash": 5.0}), crashed=True) == -5.0
    looking = Reward(**{**vars(NOTHING), "perception": 0.02, "camera_pitch": 0.0})
    assert reward(looking) == pytest.approx(0.02)
    askance = Reward(**{**vars(looking), "camera_pitch": 0.5})
    assert reward(askance) == pytest.approx(0.02 * math.exp(-10.0 * 0.5**4), rel=1e-5)


def test_the_viewing_angle_is_that_between_camera_and_gate():
    settings = Reward(camera_pitch=0.3)
    pitched = rotations.from_rotation_vector(torch.tensor([[0.0, 0.3, 0.0]]))  # nose down by as much
    assert float(viewing_angle(settings, pitched, GATE)) == pytest.approx(0.0, abs=1e-3)
    assert float(viewing_angle(settings, LEVEL, -GATE)) == pytest.approx(math.pi - 0.3, abs=1e-3)


def test_a_crash_costs_evenly_more_as_training_goes_on():
    rising = Reward(first_crash=2.0, crash=5.0)
    assert [reward_at(rising, share).crash for share in (0.0, 0.5, 1.0)] == [2.0, 3.5, 5.0]
    assert reward_at(Reward(crash=5.0), 0.0) == Reward(crash=5.0)
