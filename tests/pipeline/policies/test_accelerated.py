"""What a GPU does as CUDA graphs, run here operation by operation: the same work in the same places."""

import pytest
import torch

from simgap.policies.accelerated import CapturedCollector, CapturedLearner
from simgap.policies.collector import Collector
from simgap.policies.ppo import Learner
from simgap.policies.racing.racing import Racing
from simgap.policies.racing.randomisation import drawn_episode, drawn_wrench
from simgap.policies.racing.settings import Randomisation
from simgap.policies.settings import Learning
from simgap.policies.training import Training
from tests.pipeline.asking import Asking
from tests.pipeline.policies.environment_contract import check_contract
from tests.pipeline.policies.racing.machines import racing

LEARNING = Learning(interactions=3 * 64 * 8, machines=64, horizon=8, minibatch=200, epochs=2, hidden=[16])


def captured(batch: int) -> Racing:
    environment = racing(batch)
    environment.captured = True
    return environment


def test_a_race_that_chooses_by_masks_keeps_to_the_contract():
    environment = captured(32)
    check_contract(environment, steps=60)
    assert float(environment.state["counts"][1]) > 0  # some crashed, and started anew


def test_a_captured_step_asks_nothing_of_the_device():
    environment = captured(32)
    learner, collector = CapturedLearner(environment, LEARNING, 0), CapturedCollector(environment, 0)
    steps = collector.collect(learner.gaussian, learner.critic, 3, learner.generator).steps  # compiles
    learner.learn(steps, 0.0)
    collector._place.zero_()
    with Asking():
        collector._acting()
        learner._improving()
        drawn = drawn_episode(32, Randomisation(drag=0.3, thrust=0.1), environment.generator)
        drawn_wrench(drawn, drawn, environment.inertia)


def test_captured_collection_does_what_the_other_does():
    segments = []
    for collecting in (Collector, CapturedCollector):
        environment = captured(64)
        collector, learner = collecting(environment, 1), Learner(environment, LEARNING, 1)
        given = (learner.gaussian, learner.critic, 8, learner.generator)
        collector.collect(*given)
        places = _places(collector)
        segments.append(collector.collect(*given))
        assert _places(collector) == places  # a graph reads and writes where it was captured
    one, other = segments
    assert one.measures == other.measures
    for name in one.steps.keys():  # noqa: SIM118 - a TensorDict has rows, too
        assert torch.equal(one.steps[name], other.steps[name]), name


def _places(collector: Collector) -> list[int]:
    """Return where in memory all is that a captured step works on."""
    if not isinstance(collector, CapturedCollector):
        return []
    seen, room = collector.observation, collector._room
    kept = [seen.policy, seen.privileged, collector.returns, *collector.environment.state.values()]
    return [tensor.data_ptr() for tensor in (*kept, *(room[name] for name in sorted(room.keys())))]


def test_captured_learning_does_what_the_other_does():
    environment = captured(64)
    plain, learner = Learner(environment, LEARNING, 1), CapturedLearner(environment, LEARNING, 1)
    collector = Collector(environment, 1)
    for share in (0.0, 0.5):
        steps = collector.collect(plain.gaussian, plain.critic, 8, torch.Generator().manual_seed(3)).steps
        told, expected = learner.learn(steps, share), plain.learn(steps, share)
        assert told == pytest.approx(expected, rel=1e-3, abs=1e-6)
    for parameter, twin in zip(learner._parameters, plain._parameters, strict=True):
        torch.testing.assert_close(parameter, twin, rtol=1e-3, atol=1e-5)


def test_a_captured_training_goes_on_where_it_was_stopped(tmp_path):
    straight, stopped = Training(captured(64), LEARNING, 0), Training(captured(64), LEARNING, 0)
    straight.run()
    for _ in range(2):
        stopped.update()
    stopped._write(tmp_path / "checkpoint")
    resumed = Training(captured(64), LEARNING, 0)
    assert resumed.run(tmp_path / "checkpoint") == straight.curve
