import math

import numpy as np
import pytest
import torch

from simgap.policies.profile.motion import Motion, drive_along, drive_open_loop
from simgap.policies.profile.reference import trapezoid
from tests.pipeline.policies.profile.drives import uniform


def motion(position, velocity):
    return Motion(0.1, np.array(position), np.array(velocity), np.zeros((len(position) - 1, 4)))


def test_who_has_arrived_stays():
    passing = motion([0.0, 1.0, 1.4, 1.0, 1.0], [0.0, 0.0, 1.0, 0.0, 0.0])
    assert passing.arrival(1.0, 0.05, 0.01) == pytest.approx(0.3)
    assert math.isnan(motion([0.0, 1.0], [0.0, 1.0]).arrival(1.0, 0.05, 0.01))
    assert motion([1.0, 1.0], [0.0, 0.0]).arrival(1.0, 0.05, 0.01) == 0.0


def test_a_profile_within_the_voltage_is_followed_exactly():
    drive, period = uniform(), 0.01
    reference = trapezoid(3.0, 1.8, 2.0)
    times = period * np.arange(1, 1 + round(3.0 / period))
    followed = drive_along(drive, reference.velocities(times), period)
    np.testing.assert_allclose(followed.velocity[1:], reference.velocities(times), atol=1e-12)
    assert followed.position[-1] == pytest.approx(3.0, abs=2e-3)
    assert np.abs(followed.voltage).max() < 12.0


def test_beyond_the_voltage_a_profile_is_followed_late():
    followed = drive_along(uniform(), np.full(10, 3.0), 0.01)
    assert followed.voltage.max() == 12.0
    assert 0.0 < followed.velocity[-1] < 3.0


def test_voltages_alone_repeat_a_motion():
    drive = uniform()
    first = drive_along(drive, np.sin(np.linspace(0.0, 3.0, 100)), 0.01)
    again = drive_open_loop(drive, torch.from_numpy(first.voltage), 0.01)
    np.testing.assert_array_equal(again.position, first.position)
