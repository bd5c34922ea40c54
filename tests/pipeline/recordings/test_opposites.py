"""The two directions of one test are recognised by signals, else by names."""

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simgap.recordings.opposites import named_opposites, opposite_runs
from simgap.recordings.split import Split, runs_of, split_recording

TIME = 0.02 * np.arange(300)
SEEDS = st.integers(0, 2**31)


def smooth(seed):
    """Return a motion of 6 s, more forward than backward, that looks like no other one."""
    random = np.random.default_rng(seed)
    waves = [
        np.sin(2 * np.pi * random.uniform(0.5, 2.0) * TIME + random.uniform(0.0, 2 * np.pi)) for _ in range(6)
    ]
    return 1.2 + np.sum(waves, axis=0)


def frame(**runs):
    """Return a joint's runs from their (voltage, velocity)."""
    return pd.concat(
        [
            pd.DataFrame({"run": run, "t": 0.02 * np.arange(len(u)), "voltage": u, "velocity": v})
            for run, (u, v) in runs.items()
        ],
        ignore_index=True,
    )


def driven(voltage, gain=3.0):
    return voltage, gain * voltage


@settings(max_examples=40)
@given(
    seed=SEEDS,
    strength=st.floats(0.85, 1.15),
    noise=st.floats(0.0, 0.1),
    wait=st.integers(0, 100),
    unit=st.floats(1e-3, 1e3),
)
def test_a_mirrored_run_is_the_other_direction_in_any_unit(seed, strength, noise, wait, unit):
    motion, random = smooth(seed), np.random.default_rng(seed + 2)
    back = np.concatenate([np.zeros(wait), -strength * motion])
    back = back + noise * motion.std() * random.standard_normal(len(back))
    table = frame(a=driven(motion), b=driven(back), c=driven(smooth(seed + 1)))
    scaled = table.assign(voltage=unit * table["voltage"], velocity=table["velocity"] / unit)
    assert opposite_runs(table, "joint") == opposite_runs(scaled, "joint") == [("a", "b")]


@given(seed=SEEDS)
def test_a_repetition_and_another_test_are_no_other_direction(seed):
    motion = smooth(seed)
    assert opposite_runs(frame(a=driven(motion), b=driven(motion), c=driven(smooth(seed + 1))), "joint") == []


def test_a_sine_that_begins_elsewhere_is_a_repetition():
    whole = np.sin(2 * np.pi * 0.02 * np.arange(400))
    table = frame(**{f"r{start}": driven(whole[start : start + 300]) for start in (0, 12, 25, 37, 50)})
    assert opposite_runs(table, "joint") == []


@pytest.mark.parametrize(("size", "pairs"), [(1.0, 1), (2.0, 0)])
def test_a_stronger_test_is_another_test(size, pairs):
    step = np.ones(300)
    assert len(opposite_runs(frame(a=driven(step), b=driven(-size * step)), "joint")) == pairs


def test_a_test_that_ends_early_is_still_the_other_direction_and_a_stub_is_not():
    ramp = np.linspace(0.2, 5.0, 300)
    assert opposite_runs(frame(a=driven(ramp), b=driven(-ramp[:200])), "joint") == [("a", "b")]
    assert opposite_runs(frame(a=driven(ramp), b=driven(-ramp[:100])), "joint") == []


def test_motion_under_a_controller_counts_whatever_effort_it_takes():
    """A weight makes the effort of both directions alike."""
    speed = np.sign(np.sin(TIME)) + 0.4
    table = frame(a=(5.0 + speed, speed), b=(5.0 - speed, -speed))
    assert opposite_runs(table, "joint") == [("a", "b")]


def test_commands_against_which_the_motion_does_not_go_are_no_other_direction():
    step = np.ones(300)
    assert opposite_runs(frame(a=(step, step), b=(-step, 3.0 * step)), "joint") == []


def test_every_run_gets_one_partner_the_one_that_mirrors_it_best():
    step = np.ones(300)
    table = frame(a=driven(step), b=driven(1.1 * step), c=driven(-1.1 * step), d=driven(-step))
    assert sorted(opposite_runs(table, "joint")) == [("a", "d"), ("b", "c")]


def test_names_choose_among_partners_that_are_alike():
    step = np.ones(300)
    names = ("slow_forward_1", "slow_forward_2", "slow_backward_1", "slow_backward_2")
    table = frame(**{name: driven((1 if "forward" in name else -1) * step) for name in names})
    assert sorted(opposite_runs(table, "joint")) == [
        ("slow_backward_1", "slow_forward_1"),
        ("slow_backward_2", "slow_forward_2"),
    ]


def test_a_flight_that_goes_round_the_other_way_changes_some_channels_only():
    def flight(run, way):
        channels = dict.fromkeys(("velocity_z", "body_rate_x", "body_rate_y", "body_rate_z"), 0.0)
        circle = {"velocity_x": np.cos(TIME), "velocity_y": way * np.sin(TIME)}
        return pd.DataFrame({"run": run, "t": TIME, **channels, **circle})

    assert opposite_runs(pd.concat([flight("a", 1), flight("b", -1)]), "quadrotor") == [("a", "b")]
    assert opposite_runs(pd.concat([flight("a", 1), flight("b", 1)]), "quadrotor") == []


def test_a_swerve_drive_goes_back_with_its_modules_as_they_are():
    wheels = [f"drive_{kind}_{module}" for kind in ("voltage", "velocity") for module in range(1, 5)]
    steering = [f"steer_{kind}_{module}" for kind in ("voltage", "velocity") for module in range(1, 5)]

    def drive(run, way):
        signals = dict.fromkeys(wheels, way * np.linspace(0, 6, 300)) | dict.fromkeys(steering, 0.0)
        return pd.DataFrame({"run": run, "t": TIME, **signals})

    assert opposite_runs(pd.concat([drive("a", 1), drive("b", -1)]), "swerve") == [("a", "b")]


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("quasistatic-forward", "quasistatic-reverse"),
        ("slowForward2", "slowBackward2"),
        ("turn_cw_1", "turn_ccw_1"),
        ("step_+2.5", "step_-2.5"),
        ("step_2.5", "step_-2.5"),
        ("pos_0.06", "neg_0.06"),
        ("Clockwise", "counterclockwise"),
    ],
)
def test_names_that_differ_by_their_direction(one, other):
    assert named_opposites([one, other, "another"]) == {tuple(sorted((one, other)))}
    assert opposite_runs(frame(**{one: driven(smooth(1)), other: driven(smooth(2))}), "joint") == [
        tuple(sorted((one, other)))
    ]


@pytest.mark.parametrize(
    ("one", "other"),
    [("run-1", "run1"), ("run-1", "run-2"), ("side_left", "side_right"), ("forward_1", "backward_2")],
)
def test_names_that_differ_otherwise(one, other):
    assert named_opposites([one, other]) == set()


def test_a_recording_is_divided_by_its_seconds_and_its_tests():
    ramp, step = np.linspace(0.2, 5.0, 300), 4.0 * np.ones(120)
    runs = {
        f"{name}_{way}_{number}": driven(sign * test * (1.0 + 0.01 * number))
        for name, test in (("ramp", ramp), ("step", step))
        for number in (1, 2)
        for way, sign in (("there", 1), ("back", -1))
    }
    parts = split_recording(frame(**runs), "joint", Split(validation_fraction=0.0))
    held = runs_of(parts, "holdout")
    assert len(held) == 2
    assert {run.split("_")[1] for run in held} == {"there", "back"}
    patterns = split_recording(frame(**runs), "joint", Split(holdout=["ramp_there_*"]))
    assert runs_of(patterns, "holdout") == ["ramp_there_1", "ramp_there_2"]
