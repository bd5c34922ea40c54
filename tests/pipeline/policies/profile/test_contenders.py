from dataclasses import replace

import numpy as np
import pytest
import torch

from simgap.policies.profile import contenders
from simgap.policies.profile.rollout import drive_by_policy
from simgap.policies.profile.settings import Profile
from simgap.policies.profile.storage import FILE, read_motions, write_motions
from simgap.report.motions import draw_motions
from tests.pipeline.policies.profile.drives import uniform

TASK = Profile(acceleration_limit=8.0)
DRIVE = uniform(acceleration_limit=8.0, dtype=torch.float32)


@pytest.fixture(scope="module")
def motions():
    return contenders.classical(TASK, DRIVE) | contenders.bounds(TASK, DRIVE)


def test_all_arrive_within_their_limits(motions):
    for name, motion in motions.items():
        found = contenders.measures(motion, TASK)
        assert found["miss"] < 0.01, name
        assert found["peak_voltage"] <= 12.0 + 1e-4
        grip = np.inf if name == contenders.VOLTAGE_BOUND else 8.0
        assert np.abs(np.diff(motion.velocity)).max() <= grip * motion.period + 1e-3


def test_the_published_trapezoid_takes_what_it_says(motions):
    found = contenders.measures(motions[contenders.PUBLISHED], TASK)
    assert found["time"] == pytest.approx(2.0 * np.sqrt(1.5), abs=2 * TASK.period)


def test_higher_limits_are_faster_and_none_beats_the_bounds(motions):
    times = {name: contenders.measures(motion, TASK)["time"] for name, motion in motions.items()}
    order = [
        contenders.VOLTAGE_BOUND,
        contenders.BOUND,
        contenders.S_CURVE,
        contenders.TRAPEZOID,
        contenders.PUBLISHED,
    ]
    assert sorted(times, key=times.__getitem__) == order


def full_speed_then_brakes(observation):
    left, speed = 3.0 * observation[:, :1], 3.0 * observation[:, 3:4]
    return (left > 0.07 * speed.square()).float()


def test_a_policy_is_driven_until_it_arrives():
    task = replace(TASK, narrow=[0.2, 0.01])
    motion = drive_by_policy(full_speed_then_brakes, task, DRIVE)
    assert motion.velocity[-1] == pytest.approx(0.0, abs=0.01)
    assert abs(motion.position[-1] - 3.0) <= 0.2
    assert motion.time[-1] < 2.0


def test_a_policy_that_never_arrives_takes_forever():
    motion = drive_by_policy(lambda seen: 0.0 * seen[:, :1], TASK, DRIVE)
    found = contenders.measures(motion, TASK)
    assert np.isnan(found["time"])
    assert found["miss"] == 3.0


def test_motions_are_read_as_they_were_written(motions, tmp_path):
    write_motions(motions, tmp_path)
    read = read_motions(tmp_path / FILE)
    assert list(read) == list(motions)
    for name, motion in motions.items():
        np.testing.assert_array_equal(read[name].position, motion.position)
        np.testing.assert_array_equal(read[name].voltage, motion.voltage)
        assert read[name].period == pytest.approx(motion.period)


def test_the_picture_names_every_motion(motions, tmp_path):
    path = tmp_path / "motions.svg"
    trial = next(iter(motions.values()))
    draw_motions(motions, 3.0, path, [(trial.time, trial.position, trial.velocity)])
    text = path.read_text()
    for name in [*motions, "trials on the machine", "velocity (m/s)", "position (m)", "voltage (V)"]:
        assert name in text
    first = path.read_bytes()
    draw_motions(motions, 3.0, path, [(trial.time, trial.position, trial.velocity)])
    assert path.read_bytes() == first
