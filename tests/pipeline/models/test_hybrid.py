"""Networks with a memory, around a motion model or alone."""

import pytest
import torch

from simgap.errors import InputError
from simgap.models.contract import FitContext
from simgap.models.examples import Examples
from simgap.models.recurrent_network import RecurrentNetwork
from simgap.models.windows import gather
from tests.pipeline.models import learnable

LENGTH = 4


def network(delays: int) -> RecurrentNetwork:
    torch.manual_seed(0)
    return RecurrentNetwork(3, LENGTH, delays, 8, 2).double()


def test_a_memory_reaches_further_back_than_the_delay_line():
    generator = torch.Generator().manual_seed(1)
    samples = torch.randn((1, 12, 3), generator=generator, dtype=torch.float64)
    own = network(delays=2)

    def last(series):
        memory = own.begin(series[:, :LENGTH])
        for newest in series[:, LENGTH:].unbind(1):
            memory = own.follow(memory, newest)
        return own.read(memory)

    changed = samples.clone()
    changed[:, 0] += 1.0
    assert not torch.allclose(last(changed), last(samples))


@pytest.mark.parametrize("delays", [0, LENGTH + 1])
def test_a_delay_line_that_is_no_part_of_the_window_is_refused(delays):
    with pytest.raises(InputError, match=r"model\.delays"):
        network(delays)


@pytest.mark.parametrize("name", ["hybrid_parallel", "hybrid_serial"])
@pytest.mark.parametrize("motion", [{"name": "white_box"}, {"name": "linear", "sequence_length": 3}])
def test_a_hybrid_begins_as_its_motion_model(name, motion):
    recorded = learnable.quadrotor()
    train, validation, held = learnable.parts_of(recorded)
    model = learnable.new_model(name, recorded, motion=motion)
    model.motion.fit(train, validation, learnable.QUICK)
    model.prepare(Examples.of_series(train, model.layout, LENGTH, "training"), FitContext())
    starts = held.starts(LENGTH + 10)[:20]
    states, actions = gather(held.states, starts, LENGTH), gather(held.actions, starts, LENGTH + 9)
    seen = model.motion.settings.sequence_length
    alone = model.motion.rollout(states[:, -seen:], actions[:, LENGTH - seen :])
    assert torch.allclose(model.rollout(states, actions), alone, atol=1e-9)


def test_networks_see_and_correct_what_they_are_told_to():
    recorded = learnable.quadrotor()
    train, validation, held = learnable.parts_of(recorded)
    model = learnable.new_model(
        "hybrid_parallel", recorded, unseen=["gravity_*"], corrected=["body_rate_*"], learning_rate=0.1
    )
    model.fit(train, validation, learnable.QUICK)
    examples = Examples.of_series(held, model.layout, LENGTH, "held-out")
    windows, _ = examples.take(torch.arange(20))
    own, alone = model.increments(windows), model.motion.increments(windows)
    assert torch.equal(own[:, :3], alone[:, :3])
    assert not torch.allclose(own[:, 3:], alone[:, 3:])
    turned = windows.clone()
    turned[..., 3:6] *= -1.0
    corrections = model.increments(turned) - model.motion.increments(turned)
    assert torch.allclose(corrections, own - alone, atol=1e-12)


@pytest.mark.parametrize("key", ["unseen", "corrected"])
def test_a_pattern_that_matches_nothing_is_refused(key):
    with pytest.raises(InputError, match=rf"model\.{key}: 'body\*' matches none of"):
        learnable.new_model("hybrid_parallel", learnable.linear_joint(), **{key: ["body*"]})


@pytest.mark.parametrize(
    ("motion", "complaint"),
    [
        ({"name": "fnn"}, r"model\.motion\.name: there is no motion model 'fnn'"),
        ({"name": "linear", "sequence_length": 5}, r"model\.motion\.sequence_length"),
        ({"name": "whitebox"}, "did you mean 'white_box'"),
    ],
)
def test_what_is_no_motion_model_is_refused(motion, complaint):
    with pytest.raises(InputError, match=complaint):
        learnable.new_model("hybrid_parallel", learnable.linear_joint(), motion=motion)
