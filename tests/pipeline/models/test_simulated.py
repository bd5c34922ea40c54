"""A learned model moves a simulator, or adds what its physics leave."""

from dataclasses import replace

import pytest
import torch

from simgap.errors import InputError
from simgap.models.contract import FitContext
from simgap.models.layouts import layout_of
from simgap.models.simulated import LearnedMotion, physics_of, read_learned_simulator
from simgap.physics.shapes import Signals
from simgap.platforms import Joint
from simgap.simulation import Simulator, read_simulator, replay, replay_error, rollout, write_simulator
from simgap.simulation.blocks import cut_blocks
from simgap.simulation.learned import PHYSICS_SUBSTEPS, RESIDUAL
from simgap.simulation.motion import motion_of
from tests.pipeline.models import learnable
from tests.pipeline.platforms.machines import MACHINES

RECORDINGS = {"joint": learnable.linear_joint, "quadrotor": learnable.quadrotor, "swerve": learnable.swerve}
SLIDER = Joint(inertia=2.0)  # what moves in `learnable.linear_joint` weighs half as much
RECORDED = learnable.linear_joint()
STEP = RECORDED.time_step


def trained(name="state_space", recorded=RECORDED, layout=None, physics=None, **options):
    train, validation, _ = learnable.parts_of(recorded, layout)
    model = learnable.new_model(name, recorded, layout, **options)
    if physics is not None:
        model.explain_by(physics)
    model.fit(train, validation, learnable.QUICK, FitContext(0))
    return model


def moved(model, platform=SLIDER, role="dynamics", **options):
    learned = LearnedMotion(model, platform, role)
    return Simulator(platform, position_unit="m", learned=learned, **options)


def driven(seed=7, steps=200, batch=3) -> tuple[torch.Tensor, Signals]:
    random = torch.Generator().manual_seed(seed)
    initial = torch.randn(batch, 2, generator=random, dtype=torch.float64)
    return initial, {"effort": torch.randn(batch, steps, generator=random, dtype=torch.float64)}


@pytest.fixture(scope="module")
def linear():
    return trained(cutoff=None, ridge=0.0)


def test_a_state_space_of_a_linear_plant_is_that_plant(linear):
    initial, commands = driven()
    states = rollout(moved(linear), initial, commands, STEP)
    position, velocity = initial.unbind(-1)
    for k, effort in enumerate(commands["effort"].unbind(1)):
        faster = velocity + 0.02 * (effort - 0.8 * velocity - 3.0 * position)
        position, velocity = position + 0.01 * (velocity + faster), faster
        assert torch.allclose(states[:, k + 1], torch.stack([position, velocity], -1), atol=1e-8)


def test_it_replays_the_recording_where_the_physics_do_not(linear):
    blocks = cut_blocks(RECORDED, SLIDER, 1.0, 0.1)
    learned = replay_error(moved(linear), blocks, 0.5)
    physics = replay_error(Simulator(SLIDER, position_unit="m"), blocks, 0.5)
    for name, error in learned.items():
        assert error < 1e-9
        assert physics[name] > 0.01


def test_without_a_past_the_machine_has_always_been_as_it_is():
    model = trained("linear", sequence_length=4)
    initial, commands = driven(steps=1)
    states = initial[:, None].expand(-1, 4, -1)
    actions = commands["effort"][:, :, None].expand(-1, 4, -1)
    expected = model.predict(states, actions)
    assert torch.equal(rollout(moved(model), initial, commands, STEP)[:, 1], expected)


def test_a_longer_step_is_several_of_its_own_and_another_one_is_refused(linear):
    initial, commands = driven(steps=3)
    twice = {"effort": commands["effort"].repeat_interleave(2, dim=1)}
    fine = rollout(moved(linear), initial, twice, STEP)
    assert torch.equal(rollout(moved(linear), initial, commands, 2 * STEP), fine[:, ::2])
    with pytest.raises(InputError, match=r"0\.03 s is no multiple of the 0\.02 s"):
        rollout(moved(linear), initial, commands, 0.03)


def residual_model(name="state_space", platform=SLIDER, recorded=RECORDED, **options):
    layout = layout_of(recorded)
    simulator = Simulator(platform, position_unit="m")
    physics = physics_of(simulator, layout, recorded.time_step)
    return trained(name, recorded, physics=physics, **options), simulator


def silenced(model):
    model.restore(
        {
            name: torch.zeros_like(tensor) if name == "coefficients" else tensor
            for name, tensor in model.tensors().items()
        }
    )
    return model


@pytest.mark.parametrize("kind", RECORDINGS)
def test_a_residual_of_zero_changes_nothing(kind):
    recorded = RECORDINGS[kind]()
    platform = SLIDER if kind == "joint" else MACHINES[kind]
    model, physics = residual_model("linear", platform, recorded)
    blocks = cut_blocks(recorded, platform, 0.6, 0.1)
    motion = motion_of(platform)
    initial = motion.pack({name: blocks.inner(series)[:, 0] for name, series in blocks.signals.items()})
    states = replay(moved(silenced(model), platform, RESIDUAL), blocks, initial, 20)
    assert torch.allclose(states, replay(physics, blocks, initial, 20, PHYSICS_SUBSTEPS), atol=1e-13)


def test_a_residual_closes_what_the_physics_leave():
    model, simulator = residual_model(cutoff=None, ridge=0.0)
    initial, commands = driven(steps=100)
    truth = rollout(moved(trained(cutoff=None, ridge=0.0)), initial, commands, STEP)
    physics = rollout(simulator, initial, commands, STEP)
    mended = rollout(moved(model, role=RESIDUAL), initial, commands, STEP)
    assert (mended - truth).abs().max() < 2e-2 * (physics - truth).abs().max()


def test_a_residual_is_scored_in_its_simulator_and_not_alone():
    model, _ = residual_model(cutoff=None, ridge=0.0)
    _, _, held = learnable.parts_of(RECORDED)
    states, actions = held.states[None, :1], held.actions[None, :50]
    assert torch.allclose(model.rollout(states, actions)[0], held.states[1:51], atol=5e-2)
    model.physics = None
    with pytest.raises(InputError, match="predicts what a simulator leaves"):
        model.rollout(states, actions)


@pytest.mark.parametrize("name", ["white_box", "hybrid_parallel"])
def test_equations_of_the_whole_motion_learn_no_residual(name):
    physics = physics_of(Simulator(SLIDER), layout_of(RECORDED), STEP)
    with pytest.raises(InputError, match=r"model\.name: .* cannot learn a residual"):
        learnable.new_model(name, RECORDED).explain_by(physics)


def test_the_roles_are_not_exchanged(linear):
    with pytest.raises(InputError, match=r"simulator\.residual: .* whole motion; use simulator\.dynamics"):
        LearnedMotion(linear, SLIDER, RESIDUAL)
    with pytest.raises(InputError, match=r"use simulator\.residual"):
        LearnedMotion(residual_model()[0], SLIDER)


def test_a_layout_that_cannot_move_a_simulator_says_which_can():
    model = learnable.new_model("linear", learnable.swerve(), "steering")
    with pytest.raises(InputError, match=r"train\.layout=swerve or swerve_chassis") as refused:
        LearnedMotion(model, MACHINES["swerve"])
    assert "\n" not in str(refused.value)
    with pytest.raises(InputError, match=r"of a joint; train one with train\.layout=joint"):
        LearnedMotion(model, SLIDER)


def test_the_sliding_chassis_keeps_the_speeds_of_its_wheels():
    model = trained("linear", learnable.swerve(), "swerve_chassis")
    simulator = Simulator(MACHINES["swerve"], learned=LearnedMotion(model, MACHINES["swerve"]))
    commands = {name: torch.ones(1, 5, 4, dtype=torch.float64) for name in ("drive_voltage", "steer_voltage")}
    states = rollout(simulator, torch.zeros(1, 12, dtype=torch.float64), commands, STEP)
    rolled = model.rollout(
        torch.zeros(1, 2, 15, dtype=torch.float64), torch.ones(1, 6, 8, dtype=torch.float64)
    )
    assert torch.allclose(states[:, 1:, :3], rolled[..., :3], atol=1e-12)
    turned = 0.5 * STEP * (states[:, 1:, 2] + states[:, :-1, 2]).cumsum(1)
    assert torch.allclose(states[:, 1:, 11], turned)


def test_it_comes_back_as_it_was_written_and_without_its_model_as_physics(linear, tmp_path):
    simulator = moved(linear)
    write_simulator(simulator, tmp_path)
    initial, commands = driven(steps=20)
    again = read_learned_simulator(tmp_path)
    assert torch.equal(rollout(again, initial, commands, STEP), rollout(simulator, initial, commands, STEP))
    assert read_simulator(tmp_path) == replace(simulator, learned=None)
    first = (tmp_path / "simulator.yaml").read_bytes()
    write_simulator(again, tmp_path)
    assert (tmp_path / "simulator.yaml").read_bytes() == first


def test_another_model_than_it_was_built_with_is_refused(linear, tmp_path):
    write_simulator(moved(linear), tmp_path)
    (tmp_path / "learned" / "model.yaml").write_text("schema: simgap.model/1\n")
    with pytest.raises(InputError, match="is not the model that the simulator was built with"):
        read_learned_simulator(tmp_path)
