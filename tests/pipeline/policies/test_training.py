import multiprocessing
import os
import signal
import time
from dataclasses import replace
from pathlib import Path

import pytest
import torch

from simgap.policies.collector import Collector
from simgap.policies.networks import Policy
from simgap.policies.settings import Learning
from simgap.policies.training import CHECKPOINT_FILE, Training, final
from tests.pipeline.policies.point_mass import PointMass

QUICK = Learning(
    interactions=200_000, machines=256, horizon=20, epochs=4, minibatch=1280, discount=0.95, hidden=[32, 32]
)
FEW = Learning(interactions=30_000, machines=64, horizon=16, minibatch=256, hidden=[16], checkpoint_every=3)


def test_a_point_mass_learns_to_rest_at_its_target():
    environment = PointMass(256)
    training = Training(environment, QUICK, seed=0)
    curve = training.run()
    assert curve[-1]["interactions"] >= QUICK.interactions
    policy = Policy(training.learner.gaussian)
    observation = environment.start(1)
    for _ in range(environment.episode_steps - 1):
        observation = environment.step(policy(observation.policy)).observation
    assert float(observation.policy.abs().quantile(0.95)) < 0.1
    assert final(curve)["return"] > 2.0 * final(curve[:5], 1.0)["return"]  # both are negative


def test_the_weight_of_the_entropy_changes_from_start_to_end():
    deviations = {}
    for name, entropy in {"none": 0.0, "fading": 5.0}.items():
        for share in (0.0, 1.0):
            learning = replace(FEW, entropy=entropy, final_entropy=0.0)
            training = Training(PointMass(64), learning, seed=3)
            collector, learner = Collector(PointMass(64), 3), training.learner
            segment = collector.collect(learner.gaussian, learner.critic, 16, learner.generator)
            deviations[name, share] = learner.learn(segment.steps, share)["deviation"]
    assert deviations["fading", 0.0] > deviations["none", 0.0]
    assert deviations["fading", 1.0] == deviations["none", 1.0]


@pytest.mark.slow
def test_twin_runs_with_one_seed_are_identical():
    first, second = (Training(PointMass(64), FEW, seed=3) for _ in range(2))
    assert first.run() == second.run()
    for one, other in zip(
        first.learner.gaussian.parameters(), second.learner.gaussian.parameters(), strict=True
    ):
        assert torch.equal(one, other)
    assert Training(PointMass(64), FEW, seed=4).run() != first.curve


def _train(folder: Path) -> None:
    torch.set_num_threads(1)
    Training(PointMass(64), FEW, seed=3).run(folder, lambda entry, number: time.sleep(0.05))


@pytest.mark.slow
def test_a_killed_training_goes_on_from_its_checkpoint_as_if_nothing_had_happened(tmp_path):
    folder = tmp_path / "checkpoint"
    process = multiprocessing.get_context("spawn").Process(target=_train, args=(folder,))
    process.start()
    deadline = time.monotonic() + 60.0
    while not (folder / CHECKPOINT_FILE).exists() and time.monotonic() < deadline:
        time.sleep(0.01)
    assert process.pid is not None
    os.kill(process.pid, signal.SIGKILL)
    process.join()
    assert (folder / CHECKPOINT_FILE).exists()
    resumed, told = Training(PointMass(64), FEW, seed=3), []
    begun = len(torch.load(folder / CHECKPOINT_FILE, weights_only=True)["curve"])
    assert 0 < begun < resumed.updates
    curve = resumed.run(folder, lambda entry, number: told.append(number))
    assert told == list(range(resumed.updates))
    assert curve == Training(PointMass(64), FEW, seed=3).run()


def test_rewards_are_scaled_for_the_learner_alone():
    scaled = Learning(**{**vars(FEW), "reward_scale": 3.0})
    plain, larger = (Training(PointMass(64), settings, seed=0) for settings in (FEW, scaled))
    plain.update(), larger.update()
    assert plain.curve[0]["reward"] == larger.curve[0]["reward"]
    assert plain.curve[0]["loss_critic"] != larger.curve[0]["loss_critic"]


def test_the_end_of_a_curve_is_the_mean_of_its_last_part():
    curve = [{"reward": float(number)} for number in range(20)] + [{"reward": 30.0, "return": 1.0}]
    assert final(curve) == {"reward": pytest.approx((18 + 19 + 30) / 3), "return": 1.0}
