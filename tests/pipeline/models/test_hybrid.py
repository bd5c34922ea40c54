"""Networks with a memory, around a motion model or alone."""

import pytest
import torch
from torch import nn

from simgap.errors import InputError
from simgap.models.contract import FitContext
from simgap.models.examples import Examples
from simgap.models.recurrent_network import Memory, RecurrentNetwork
from simgap.models.windows import gather
from tests.pipeline.models import learnable

LENGTH = 4


def network(delays: int, layers: int = 1) -> RecurrentNetwork:
    torch.manual_seed(0)
    return RecurrentNetwork(3, LENGTH, delays, 8, 2, layers).double()


@pytest.mark.parametrize("layers", [1, 3])
def test_a_memory_reaches_further_back_than_the_delay_line(layers):
    generator = torch.Generator().manual_seed(1)
    samples = torch.randn((1, 12, 3), generator=generator, dtype=torch.float64)
    own = network(2, layers)

    def last(series):
        memory = own.begin(series[:, :LENGTH])
        for newest in series[:, LENGTH:].unbind(1):
            memory = own.follow(memory, newest)
        return own.read(memory)

    changed = samples.clone()
    changed[:, 0] += 1.0
    assert not torch.allclose(last(changed), last(samples))


def trained(name: str, **options):
    """Return a hybrid after a short training on flights, and held-out windows."""
    recorded = learnable.quadrotor()
    train, validation, held = learnable.parts_of(recorded)
    model = learnable.new_model(name, recorded, **options)
    model.fit(train, validation, learnable.QUICK)
    examples = Examples.of_series(held, model.layout, LENGTH, "held-out")
    return model, examples.take(torch.arange(20))[0]


@pytest.mark.parametrize("delays", [0, LENGTH + 1])
def test_a_delay_line_that_is_no_part_of_the_window_is_refused(delays):
    with pytest.raises(InputError, match=r"model\.delays"):
        network(delays)


def test_a_stack_without_a_layer_is_refused():
    with pytest.raises(InputError, match=r"model\.layers"):
        network(1, layers=0)


def test_a_stack_is_lstm_on_lstm_as_torch_has_it():
    own = network(1, layers=3)
    reference = nn.LSTM(3, 8, 3, batch_first=True).double()
    for index, layer in enumerate(own.stack):
        for name in ("weight_ih", "weight_hh", "bias_ih", "bias_hh"):
            getattr(reference, f"{name}_l{index}").data = getattr(layer, name).data
    samples = torch.randn((2, 9, 3), generator=torch.Generator().manual_seed(1), dtype=torch.float64)
    start = torch.zeros(3, 2, 8, dtype=torch.float64)
    memory = Memory(samples[:, :1], samples[:, 0, :0], start, start)
    for newest in samples.unbind(1):
        memory = own.follow(memory, newest)
    _, (hidden, cell) = reference(samples)
    assert torch.allclose(memory.hidden, hidden)
    assert torch.allclose(memory.cell, cell)


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
    # The serial hybrid passes the increments through single precision.
    assert torch.allclose(model.rollout(states, actions), alone, atol=1e-6)


@pytest.mark.parametrize("name", ["hybrid_parallel", "hybrid_serial"])
def test_networks_see_drive_and_correct_what_they_are_told_to(name):
    options = {"unseen": ["gravity_*"], "driven": [], "corrected": ["body_rate_*"], "learning_rate": 0.1}
    model, windows = trained(name, **options)
    own, alone = model.increments(windows), model.motion.increments(windows)
    assert torch.equal(own[:, :3], alone[:, :3])
    assert not torch.allclose(own[:, 3:], alone[:, 3:])
    turned = windows.clone()
    turned[..., 3:6] *= -1.0
    corrections = model.increments(turned) - model.motion.increments(turned)
    assert torch.allclose(corrections, own - alone, atol=1e-7)


@pytest.mark.parametrize("name", ["hybrid_parallel", "hybrid_serial"])
def test_all_three_parts_are_learned_and_the_errors_before_compensation_are_those_of_two(name):
    model, windows = trained(name)
    chain = model.parts()["uncompensated"]
    own, driven, alone = (part.increments(windows) for part in (model, chain, model.motion))
    assert not torch.allclose(own, driven)
    assert not torch.allclose(driven, alone)
    assert all(change.abs().max() > 0.0 for change in model.motion.changes)
    memory = model.begin(windows)
    assert torch.equal(driven, memory.motion)
    again = model.compensate(memory.motion, model.network.output.read(memory.output))
    assert torch.equal(own, again)


def test_a_motion_model_can_keep_its_coefficients():
    model, _ = trained("hybrid_parallel", motion_learned=False)
    assert model.motion.changes is None
    assert not len(model.network.changes)


@pytest.mark.parametrize("key", ["unseen", "driven", "corrected"])
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
