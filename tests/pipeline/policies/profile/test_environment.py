from dataclasses import replace

import numpy as np
import pytest
import torch

from simgap.policies.profile.environment import MotionProfile
from simgap.policies.profile.motion import drive_along
from simgap.policies.profile.settings import Profile
from simgap.policies.profile.time_optimal import time_optimal
from tests.pipeline.policies.environment_contract import check_contract
from tests.pipeline.policies.profile.drives import uniform

TASK = Profile(period=0.01, acceleration_limit=float("inf"))
FROM_REST = replace(TASK, on_the_way=0.0)


def environment(task=TASK, batch=16):
    drive = uniform(dtype=torch.float32, acceleration_limit=task.acceleration_limit)
    return MotionProfile(task, drive, batch)


def test_it_keeps_to_the_contract():
    check_contract(environment(replace(TASK, episode=0.6)), steps=100)


def test_a_step_is_that_of_the_identified_drive():
    made = environment(FROM_REST, batch=1)
    made.start(0)
    desired = 3.0 * np.sin(np.linspace(0.0, 2.0, 60))
    for wanted in desired:
        made.step(torch.tensor([[wanted / 3.0]], dtype=torch.float32))
    followed = drive_along(made.drive, desired, 0.01)
    assert float(made.state["position"]) == pytest.approx(followed.position[-1], abs=1e-4)
    assert made.state["velocity"][0].mean() == pytest.approx(followed.velocity[-1], abs=1e-4)


def arrive(made):
    """Drive at full speed until the brakes are needed, and then stand; return the last transition and the steps."""
    seen = made.start(0)
    for step in range(made.episode_steps):
        left, speed = float(seen.policy[0, 0]) * 3.0, float(seen.policy[0, 3]) * 3.0
        braking = left < 0.056 * speed * speed
        transition = made.step(torch.tensor([[0.0 if braking else 1.0]]))
        if bool(transition.terminated):
            return transition, step + 1
        seen = transition.observation
    raise AssertionError("it did not arrive")


def test_who_comes_to_rest_at_the_target_has_arrived():
    made = environment(replace(FROM_REST, narrow=[0.2, 0.01]), batch=1)
    transition, steps = arrive(made)
    assert float(transition.reward) > 900.0
    assert steps * 0.01 > 0.98 * time_optimal(made.drive, 2.8, 3.0).time[-1]
    assert float(transition.observation.policy[0, 0]) == 1.0  # at the start of the next attempt
    assert made.measures()["arrived"] == 1.0
    made.schedule(0.0)
    assert made.measures()["arrived"] == 0.0


def test_who_leaves_the_way_has_failed():
    made = environment(FROM_REST, batch=1)
    made.start(0)
    transitions = [made.step(torch.tensor([[-1.0]])) for _ in range(60)]
    failed = next(entry for entry in transitions if bool(entry.terminated))
    assert float(failed.reward) < -100.0


def test_arriving_becomes_harder_as_fast_as_the_attempts_arrive():
    made = environment(replace(FROM_REST, curriculum=4, success=0.5), batch=1)
    made.start(0)
    made.schedule(0.0)
    assert made.tolerances == pytest.approx(tuple(TASK.wide))
    made.schedule(0.0)  # nothing ended since
    assert made.tolerances == pytest.approx(tuple(TASK.wide))
    seen = []
    for _ in range(6):
        made.state["ended"], made.state["arrived"] = torch.tensor(10.0), torch.tensor(5.0)
        made.schedule(0.0)
        seen.append(made.tolerances[0])
    ratio = (TASK.narrow[0] / TASK.wide[0]) ** 0.25
    assert seen == pytest.approx([TASK.wide[0] * ratio ** min(n, 4) for n in range(1, 7)])
    made.state["ended"], made.state["arrived"] = torch.tensor(10.0), torch.tensor(4.0)
    made.schedule(0.0)
    assert made.tolerances[0] == seen[-1]


def test_only_whole_ways_count_towards_the_next_tolerance():
    made = environment(replace(TASK, on_the_way=1.0, episode=0.1), batch=8)
    made.start(0)
    made.schedule(0.0)
    for _ in range(30):
        made.step(torch.zeros(8, 1))
    assert float(made.state["ended"]) == 0.0
    whole = environment(replace(FROM_REST, episode=0.1), batch=8)
    whole.start(0)
    whole.schedule(0.0)
    for _ in range(30):
        whole.step(torch.zeros(8, 1))
    assert float(whole.state["ended"]) == 24.0


def test_some_attempts_start_on_the_way_and_the_others_at_rest():
    made = environment(batch=1000)
    made.start(0)
    resting = (made.state["position"] == 0.0) & (made.state["velocity"] == 0.0).all(-1)
    assert 0.4 < float(resting.float().mean()) < 0.6
    assert float(made.state["position"].max()) <= 3.0


def test_wheels_that_differ_are_where_they_are_on_average():
    made = environment(FROM_REST, batch=1)
    uneven = replace(made.drive, speed=made.drive.speed * torch.tensor([0.98, 1.0, 1.0, 1.02]))
    made = MotionProfile(FROM_REST, uneven, 1)
    made.start(0)
    for _ in range(30):
        made.step(torch.tensor([[1.0]]))
    assert float(made.state["velocity"].std()) > 0.0
    assert 0.0 < float(made.state["position"]) < 1.0
