import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from simgap.effects import effect_by_key
from simgap.equations.residuals import (
    channel_series,
    quadrature_of_rows,
    residual_rows,
    row_weights,
    signals_inside,
)
from simgap.equations.row_noise import noise_of_rows
from simgap.equations.sample_noise import sample_noise
from simgap.gap.prepare import prepare
from simgap.gap.settings import Gap
from simgap.physics.weak_form import mean_rate_of, window_functions
from simgap.platforms import Joint, JointMotor
from simgap.recordings.recording import Recording
from simgap.simulation import FittedEffect, Simulator, rollout
from simgap.simulation.blocks import Blocks, cut_blocks
from simgap.simulation.motion import motion_of
from tests.pipeline.gap.problems import blocks_of, problem_of, random_like
from tests.pipeline.gap.recordings import (
    JOINT,
    Plant,
    joint_recording,
    joint_recordings,
    joint_simulator,
    racer,
)
from tests.pipeline.platforms.machines import MACHINES
from tests.pipeline.simulation.drives import driven


def _as_blocks(simulator: Simulator, states: torch.Tensor, commands: dict, step: float) -> Blocks:
    """Return a rollout as if it had been recorded, commands at the samples, without margins."""
    signals = motion_of(simulator.platform).signals(states) | commands
    count = len(states)
    return Blocks(
        signals,
        torch.zeros(count, dtype=torch.long),
        ("run",),
        torch.zeros(count).double(),
        step,
        0,
        states.shape[1],
    )


def _simulated(simulator: Simulator, step: float) -> Blocks:
    """Roll out 0.3 s under smooth commands."""
    steps = round(0.3 / step)
    time = torch.arange(steps + 1, dtype=torch.float64) * step
    phases = torch.arange(3, dtype=torch.float64)[:, None]
    if simulator.platform.kind == "joint":
        command = {"voltage": 4.0 * torch.sin(9.0 * time + phases)}
        initial = torch.zeros(3, 2, dtype=torch.float64)
    else:
        wobble = torch.sin(7.0 * time[:, None] + torch.arange(4) + phases[..., None])
        command = {"rotor_speed": simulator.platform.hover_rotor_speed * (1.0 + 0.01 * wobble)}
        initial = torch.zeros(3, 13, dtype=torch.float64)
        initial[:, 3] = 1.0
        initial[:, 7:9] = 3.0
    held = {name: 0.5 * (series[:, :-1] + series[:, 1:]) for name, series in command.items()}
    return _as_blocks(simulator, rollout(simulator, initial, held, step), command, step)


def _joint(name: str, **values: float) -> Simulator:
    return Simulator(JOINT, (FittedEffect(effect_by_key("joint", name), values),))


def _racer(name: str, **values: float) -> Simulator:
    return Simulator(racer(), (FittedEffect(effect_by_key("quadrotor", name), values),))


@pytest.mark.parametrize(
    "simulator",
    [
        Simulator(JOINT),
        _joint("viscous_friction", coefficient=0.1),
        _joint("inertia_error", ratio=1.3),
        _joint("current_limit", limit=2.0),
        Simulator(racer()),
        _racer("rotor_drag", coefficient=0.4),
        _racer("mass_error", ratio=1.1),
        _racer("angular_drag", coefficient=0.01),
    ],
    ids=lambda s: "+".join([s.platform.kind, *(f.effect.name for f in s.effects)]),
)
def test_a_simulator_leaves_nothing_of_its_own_recording(simulator):
    """What is left falls with the square of the time step: it is the quadrature's, not the simulator's."""
    left = []
    for step in (0.01, 0.005):
        blocks = _simulated(simulator, step)
        functions = window_functions(blocks.samples, 0.2, step)
        bare = replace(simulator, effects=())
        size = residual_rows(bare, blocks, functions).abs().amax((0, 1)).clamp_min(1e-9)
        left.append(residual_rows(simulator, blocks, functions).abs().amax((0, 1)))
    assert (left[1] < 0.4 * left[0] + 1e-9).all()
    if simulator.effects:
        assert (left[1] / size).min() < 0.02


def test_the_noise_of_rows_is_their_spread_over_seeds():
    """24 recordings of one motion: 24 × 512 correlated rows know the spread to about 3 %; 10 % is allowed."""
    simulator = joint_simulator()
    quiet = joint_recordings(Plant(), [0], noise=0.0)[0]
    rows, stated = [], []
    for seed in range(24):
        frame = quiet.frame.copy()
        frame["velocity"] += 0.02 * random_like((len(frame),), seed).numpy()
        problem = problem_of(replace(quiet, frame=frame), simulator)
        rows.append(residual_rows(simulator, problem.blocks, problem.functions))
        stated.append(float(problem.noise[0]))
    spread = float(torch.stack(rows).std(0).square().mean().sqrt())
    assert sum(stated) / len(stated) == pytest.approx(spread, rel=0.1)


def test_sample_noise_is_the_variance_and_ignores_smooth_motion_and_steps():
    noise = 0.3 * random_like((200, 100), seed=2)
    time = torch.arange(100, dtype=torch.float64) * 0.01
    smooth = 5.0 * torch.sin(10.0 * time) + 3.0 * (time > 0.5)
    # 20,000 squares of sixth-order differences, their median: 3 % standard error
    assert float(sample_noise(noise + smooth)) == pytest.approx(0.09, rel=0.1)
    assert float(sample_noise(smooth[None] - 3.0 * (time > 0.5))) < 1e-8


@pytest.mark.parametrize("ratio", [1.0, 1.5, 3.0])
def test_a_parameter_error_cannot_shrink_the_residual_by_shrinking_the_momentum(ratio):
    """Under every inertia that is believed, a friction of the same torque leaves the same share of the motion.

    Once the residual was in terms of the believed inertia, and a wrong inertia 'explained' any effect.
    """
    quiet = joint_recording(Plant(viscous=0.05), noise=0.0)
    blocks = blocks_of(quiet, joint_simulator())
    functions = window_functions(blocks.samples, 0.2, blocks.time_step)
    nominal = residual_rows(joint_simulator(), blocks, functions)
    inertia = effect_by_key("joint", "inertia_error")
    scaled = residual_rows(joint_simulator(FittedEffect(inertia, {"ratio": ratio})), blocks, functions)
    signals = joint_simulator().along_time(blocks.acting, blocks.time_step)
    effort = blocks.at_samples(blocks.acting_inside(signals["effort"])) @ functions.weights.T
    torch.testing.assert_close(scaled[..., 0], nominal[..., 0] + (1.0 - 1.0 / ratio) * effort)


def test_both_sides_noise_enters_where_the_accelerometer_does_not():
    """Noise on the position changes nothing; on the velocity it does, by the gain of the slopes and no less."""
    quiet = joint_recording(Plant(), noise=0.0)
    simulator = joint_simulator()
    blocks = blocks_of(quiet, simulator)
    functions = window_functions(blocks.samples, 0.2, blocks.time_step)
    noise = 0.05 * random_like(tuple(blocks.signals["velocity"].shape), seed=3)
    shaken = replace(blocks, signals={**blocks.signals, "velocity": blocks.signals["velocity"] + noise})
    moved = replace(blocks, signals={**blocks.signals, "position": blocks.signals["position"] + noise})
    rate_gain = math.sqrt(float(functions.slopes.square().sum(1).mean()))
    least = JOINT.inertia * 0.05 * rate_gain
    assert float(noise_of_rows(simulator, moved, functions)) == pytest.approx(
        float(noise_of_rows(simulator, blocks, functions))
    )
    assert least < 1.05 * float(noise_of_rows(simulator, shaken, functions)) < 2.0 * least


@given(seed=st.integers(0, 10**6), settling=st.floats(0.1, 3.0))
def test_an_axis_that_settles_within_a_few_samples_leaves_nothing_under_held_commands(seed, settling):
    """Known exactly at any jump of the voltage: v[k+1] = a·v[k] + (1 − a)·u[k] / gain, a = exp(−2·settling)."""
    step, motor = 0.01, JointMotor(resistance=2.0, torque_constant=0.03, gear_ratio=20.0)
    gain = motor.torque_constant * motor.gear_ratio
    joint = Joint(inertia=gain**2 / motor.resistance * step / (2.0 * settling), motor=motor)
    voltage = 6.0 * np.random.default_rng(seed).standard_normal(200)
    velocity, left = np.zeros(200), math.exp(-2.0 * settling)
    for sample in range(199):
        velocity[sample + 1] = left * velocity[sample] + (1.0 - left) * voltage[sample] / gain
    columns = {"run": "run", "t": np.arange(200) * step, "position": np.zeros(200), "velocity": velocity}
    frame = pd.DataFrame(columns | {"voltage": voltage})
    recording = Recording(frame, "joint", dict.fromkeys(columns, "1"), cleaned=True)
    blocks = cut_blocks(recording, joint, 0.6, 0.1, held=True)
    functions = window_functions(blocks.samples, 0.2, step)
    rows = residual_rows(Simulator(joint), blocks, functions)
    assert float(rows.abs().max()) < 1e-12 * gain / motor.resistance * np.abs(voltage).max()


def test_a_window_with_a_command_that_was_made_up_counts_nothing():
    problem = problem_of(joint_recording(Plant(friction=0.3)), joint_simulator())
    blocks, functions = problem.blocks, problem.functions
    filled = torch.zeros_like(blocks.signals["position"])
    filled[0, blocks.margin + int(functions.centres[1])] = 1.0
    marked = replace(blocks, signals={**blocks.signals, "filled": filled})
    weights = row_weights(joint_simulator(), marked.signals, marked, functions)[..., 0]
    assert weights[0, 1] == 0.0
    assert (weights == 0.0).sum() <= 3  # its neighbours overlap
    assert float(weights.square().mean()) == pytest.approx(1.0)
    simulator = joint_simulator()
    whole, part = (residual_rows(simulator, b, functions) for b in (blocks, marked))
    torch.testing.assert_close(part, whole * weights[..., None])


def test_where_most_windows_hold_a_made_up_command_all_count():
    problem = problem_of(joint_recording(Plant()), joint_simulator())
    marked = replace(
        problem.blocks,
        signals={**problem.blocks.signals, "filled": torch.ones_like(problem.blocks.signals["position"])},
    )
    assert bool((row_weights(joint_simulator(), marked.signals, marked, problem.functions) == 1.0).all())


@pytest.mark.slow
@pytest.mark.parametrize("step", [0.01, 0.005])
def test_the_quadrature_of_a_turning_swerve_is_told_from_the_recording(step):
    """What a drive recorded without noise leaves of its own simulator is the quadrature's, within a factor of two."""
    simulator = Simulator(MACHINES["swerve"])
    states, commands = driven(simulator, 2, round(4.0 / step), step, seed=3)
    inner = motion_of(simulator.platform).signals(states, simulator.constants())
    samples = states.shape[1]
    blocks = Blocks(
        signals=inner | commands, run=torch.arange(2), runs=("a", "b"), start=torch.zeros(2, dtype=torch.float64),
        time_step=step, margin=2, samples=samples - 4, held_commands=commands,
    )  # fmt: skip
    functions = window_functions(blocks.samples, 0.2, step)
    left = residual_rows(simulator, blocks, functions).square().mean((0, 1)).sqrt()
    told = quadrature_of_rows(simulator, blocks, functions)
    assert (told[:3] > 0.5 * left[:3]).all()
    assert (told[:3] < 2.0 * left[:3]).all()


def test_the_midpoint_of_a_linear_axis_misses_nothing():
    problem = problem_of(joint_recording(Plant(viscous=0.05)), joint_simulator())
    assert float(quadrature_of_rows(joint_simulator(), problem.blocks, problem.functions)) < 1e-12
    measured = replace(problem.blocks, held=False)
    assert float(quadrature_of_rows(joint_simulator(), measured, problem.functions)) == 0.0


def test_friction_over_the_samples_in_which_an_axis_turns_round_leaves_less_than_one_resolution_for_all():
    recording, truth = joint_recording(Plant(friction=0.3), noise=0.05), {"level": 0.3}
    friction = FittedEffect(effect_by_key("joint", "coulomb_friction"), truth, known=True)
    prepared = prepare(recording, joint_simulator(friction), Gap(), held=True)
    blocks, functions = prepared.problem.blocks, prepared.problem.functions
    over_samples, at_large = (
        float(residual_rows(prepared.nominal, each, functions).square().mean())
        for each in (blocks, replace(blocks, resolution={}))
    )
    assert over_samples < 0.5 * at_large


def test_a_motor_that_stays_inside_the_gap_explains_no_motion_of_its_load():
    """With half of the inertia in a gap that it never crosses, nothing drives the load: its error is whole."""
    problem = problem_of(joint_recording(Plant()), joint_simulator())
    wide = FittedEffect(effect_by_key("joint", "backlash"), {"gap": 100.0, "motor_inertia_share": 0.5})
    simulator = joint_simulator(wide)
    momentum = next(iter(channel_series(joint_simulator(), problem.blocks)))
    rate = mean_rate_of(problem.functions, momentum.measured, problem.blocks.held)
    inner = signals_inside(simulator, problem.blocks, problem.blocks.acting)
    inside = row_weights(simulator, inner, problem.blocks, problem.functions)[..., 0] > 1.999
    assert float(inside.double().mean()) > 0.3
    left = problem.residual(simulator)[..., 0]
    torch.testing.assert_close(left[inside], rate[inside], rtol=0.05, atol=0.2 * float(rate.std()))
