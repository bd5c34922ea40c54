"""A recording cut into blocks, and a simulator that replays what it recorded of itself."""

from itertools import pairwise

import numpy as np
import pandas as pd
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from simgap.effects import CommandEffect, MeasurementEffect, effect_by_key, effects_of
from simgap.errors import InputError
from simgap.recordings.recording import Recording
from simgap.simulation import FittedEffect, Simulator, replay, replay_error
from simgap.simulation.blocks import cut_blocks
from simgap.simulation.motion import motion_of
from tests.pipeline.platforms.machines import JOINT, MACHINES, QUADROTOR, some_signals
from tests.pipeline.simulation.flights import recorded, smooth

STEP = 0.005


def counted(lengths: list[list[int]]) -> Recording:
    """Return a joint recording whose position counts all of its samples, and whose velocity says the segment."""
    rows, count, number = [], 0, 0
    for run, segments in enumerate(lengths):
        clock = 0.0
        for segment, samples in enumerate(segments):
            for _ in range(samples):
                rows.append((f"run{run}", clock, segment, float(count), float(number), 0.0))
                count, clock = count + 1, clock + 0.01
            clock, number = clock + 1.0, number + 1
    frame = pd.DataFrame(rows, columns=["run", "t", "segment", "position", "velocity", "effort"])
    return Recording(frame, "joint", {"position": "rad", "velocity": "rad/s", "effort": "N·m"}, cleaned=True)


segments = st.lists(st.lists(st.integers(1, 90), min_size=1, max_size=3), min_size=1, max_size=3)


@given(lengths=segments, duration=st.floats(0.1, 1.0), margin=st.floats(0.0, 0.3))
@settings(max_examples=20)
def test_blocks_stay_inside_a_segment_do_not_overlap_and_cover_every_run(lengths, duration, margin):
    recording = counted(lengths)
    longest = [max(run) for run in lengths]
    if max(longest) < 10:
        with pytest.raises(InputError, match="is too short to be replayed"):
            cut_blocks(recording, JOINT, duration, margin)
        return
    blocks = cut_blocks(recording, JOINT, duration, margin)
    place, segment = blocks.signals["position"], blocks.signals["velocity"]
    assert place.shape[1] == blocks.samples + 2 * blocks.margin
    inner = blocks.inner(place)
    assert (torch.diff(inner, dim=1) == 1.0).all()
    assert (segment == segment[:, :1]).all()
    assert len(torch.unique(inner)) == inner.numel()
    steps = torch.diff(place, dim=1)
    assert ((steps == 0.0) | (steps == 1.0)).all()
    covered = {blocks.runs[index] for index in blocks.run.tolist()}
    assert covered >= {f"run{run}" for run, most in enumerate(longest) if most >= 30}
    frame = recording.frame
    for block in range(len(blocks)):
        row = frame.iloc[int(inner[block, 0])]
        assert blocks.runs[int(blocks.run[block])] == row["run"]
        assert float(blocks.start[block]) == row["t"]


def test_a_position_acts_with_its_mean_through_each_step():
    """Exact where the velocity runs in straight lines between samples, as it does under held efforts."""
    step, count = 0.01, 200
    acceleration = np.random.default_rng(0).standard_normal(count)
    velocity = np.cumsum(np.r_[0.0, acceleration[:-1]]) * step
    position = np.cumsum(np.r_[0.0, velocity[:-1] * step + 0.5 * acceleration[:-1] * step**2])
    frame = pd.DataFrame({"t": step * np.arange(count), "position": position, "velocity": velocity})
    frame["run"], frame["effort"] = "a", acceleration
    units = {"position": "rad", "velocity": "rad/s", "effort": "N·m"}
    blocks = cut_blocks(Recording(frame, "joint", units, cleaned=True), JOINT, 1.0, 0.1)
    first = slice(blocks.margin, blocks.margin + blocks.samples)
    means = position + velocity * step / 2.0 + acceleration * step**2 / 6.0
    found = blocks.acting["position"][0, first].numpy()
    np.testing.assert_allclose(found, means[: blocks.samples], rtol=0.0, atol=1e-14)


def test_blocks_of_chosen_runs_and_thinned_blocks_are_a_part_of_them():
    blocks = cut_blocks(counted([[200], [100, 120], [90]]), JOINT, 0.2, 0.05)
    some = blocks.of_runs(["run2", "run0"])
    assert {blocks.runs[index] for index in some.run.tolist()} == {"run0", "run2"}
    assert len(some) + len(blocks.of_runs(["run1"])) == len(blocks)
    assert len(blocks.thinned(4)) == 4
    assert blocks.thinned(4).start[0] == blocks.start[0]
    assert blocks.thinned(10**6) is blocks
    assert len(blocks.of_runs([])) == 0


def test_a_recording_that_was_not_cleaned_is_refused():
    rough = counted([[100]])
    raw = Recording(rough.frame, rough.kind, rough.units)
    with pytest.raises(InputError, match="clean it first"):
        cut_blocks(raw, JOINT, 0.2, 0.05)


def test_a_signal_with_a_missing_value_is_left_out():
    recording = counted([[100]])
    recording.frame["temperature"] = np.where(recording.frame.index == 50, np.nan, 20.0)
    assert "temperature" not in cut_blocks(recording, JOINT, 0.2, 0.05).signals


def own_recording(simulator: Simulator, runs: int = 2, steps: int = 200) -> Recording:
    """Record a simulator under smooth commands, so smooth that it does not matter how they are held."""
    kind = simulator.platform.kind
    first = some_signals(kind, (runs,), seed=5)
    still = torch.zeros(runs, steps, dtype=torch.float64)
    supply = {"battery_voltage": 12.0 + still}
    if kind == "quadrotor":
        speed = QUADROTOR.hover_rotor_speed + 60.0 * smooth((runs, 1, 4), STEP, 1).expand(runs, steps, 4)
        speed = speed + 20.0 * smooth((runs, steps, 4), STEP, 2)
        initial = motion_of(QUADROTOR).pack(first | {"body_rate": 0.1 * first["body_rate"]})
        return recorded(
            simulator, initial, {"motor_command": speed / QUADROTOR.motor_speed_max} | supply, STEP
        )
    if kind == "joint":
        initial = motion_of(JOINT).pack(first)
        commands = {"voltage": 6.0 * smooth((runs, steps), STEP, 3), "temperature": 40.0 + still}
        return recorded(simulator, initial, commands | supply, STEP)
    commands = {f"{group}_voltage": 6.0 * smooth((runs, steps, 4), STEP, 4) for group in ("drive", "steer")}
    # Wheels that cross each other's way enlarge any error.
    along = {"steer_angle": 0.2 * first["steer_angle"], "heading": torch.zeros(runs).double()}
    initial = 0.3 * motion_of(simulator.platform).pack(first | along)
    return recorded(simulator, initial, commands | supply, STEP)


def everything(kind: str) -> Simulator:
    """Return a machine with every effect whose state is known at any sample of a recording on its own clock."""
    effects = [
        effect
        for effect in effects_of(kind)
        if not isinstance(effect, MeasurementEffect)
        and (isinstance(effect, CommandEffect) or not getattr(effect, "remembers", False))
    ]
    return Simulator(MACHINES[kind], tuple(FittedEffect(effect, effect.defaults()) for effect in effects))


@pytest.mark.slow
@pytest.mark.parametrize("kind", list(MACHINES))
def test_a_simulator_reproduces_its_own_recording_and_the_nominal_one_does_not(kind):
    simulator = everything(kind)
    blocks = cut_blocks(own_recording(simulator, runs=1, steps=90), simulator.platform, 0.15, 0.05)
    own = replay_error(simulator, blocks, 0.1)
    nominal = replay_error(Simulator(simulator.platform), blocks, 0.1)
    for part in own:
        assert own[part] < 0.03 * nominal[part] + 1e-9, part


def test_a_hidden_state_is_known_the_better_the_longer_the_margin():
    """Current that follows its voltage with a time constant of 20 ms is forgotten by a factor of e in each."""
    inductance = FittedEffect(effect_by_key("joint", "motor_inductance"), {"inductance": 0.04})
    simulator = Simulator(JOINT, (inductance,))
    recording = own_recording(simulator, runs=6)
    soon, later, late = (
        replay_error(simulator, cut_blocks(recording, JOINT, 0.2, margin), 0.05)["replay_error_velocity"]
        for margin in (0.02, 0.06, 0.1)
    )
    assert later < 0.2 * soon
    assert late < 0.2 * later


def test_a_held_effort_is_replayed_without_loss_of_its_impulse():
    simulator = Simulator(JOINT)
    effort = torch.zeros(1, 120, dtype=torch.float64)
    effort[:, 50:55] = 0.3
    recording = recorded(simulator, torch.zeros(1, 2, dtype=torch.float64), {"effort": effort}, STEP)
    blocks = cut_blocks(recording, JOINT, 0.2, 0.05)
    signals = {name: blocks.inner(series) for name, series in blocks.signals.items()}
    states = replay(simulator, blocks, motion_of(JOINT).pack(signals)[:, 0], blocks.samples - 1)
    torch.testing.assert_close(states[..., 1], signals["velocity"], rtol=0.0, atol=0.3 * STEP / JOINT.inertia)
    torch.testing.assert_close(states[:, -1], motion_of(JOINT).pack(signals)[:, -1], rtol=0.0, atol=2e-3)


def test_a_block_may_start_in_the_middle_of_a_delay():
    """What was commanded before a block acts inside it; the margin remembers."""
    effect = effect_by_key("joint", "command_delay")
    simulator = Simulator(JOINT, (FittedEffect(effect, {"delay": 0.06}),))
    blocks = cut_blocks(own_recording(simulator), JOINT, 0.2, 0.1)
    late = replay_error(simulator, blocks, 0.15)
    prompt = replay_error(Simulator(JOINT), blocks, 0.15)
    assert late["replay_error_velocity"] < 0.01 * prompt["replay_error_velocity"]


def test_a_simulator_that_diverges_has_an_infinite_error_and_no_missing_one():
    blocks = cut_blocks(own_recording(Simulator(JOINT)), JOINT, 0.3, 0.05)
    wild = Simulator(
        JOINT, (FittedEffect(effect_by_key("joint", "viscous_friction"), {"coefficient": -1e4}),)
    )
    assert all(value == np.inf or value > 1e6 for value in replay_error(wild, blocks, 0.3).values())


def test_a_replay_starts_and_ends_at_the_velocity_without_its_filter():
    simulator, constant = Simulator(JOINT), 0.02
    recording = own_recording(simulator, runs=2)
    for _, run in recording.frame.groupby("run"):
        late, velocity = [run["velocity"].iloc[0]], run["velocity"].to_numpy()
        for before, now in pairwise(velocity):
            kept, share = np.exp(-STEP / constant), constant / STEP * (1.0 - np.exp(-STEP / constant))
            late.append(kept * late[-1] + (share - kept) * before + (1.0 - share) * now)
        recording.frame.loc[run.index, "velocity"] = late
    blocks = cut_blocks(recording, JOINT, 0.2, 0.1)
    effect = effect_by_key("joint", "velocity_filter")
    aware = Simulator(JOINT, (FittedEffect(effect, {"time_constant": constant}),))
    own, nominal = (replay_error(each, blocks, 0.1)["replay_error_velocity"] for each in (aware, simulator))
    assert own < 0.1 * nominal
