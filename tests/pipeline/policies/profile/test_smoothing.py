import numpy as np
import pytest
import torch

from simgap.policies.profile.motion import drive_along, drive_open_loop
from simgap.policies.profile.reference import trapezoid
from simgap.policies.profile.smoothing import smoothed
from tests.pipeline.policies.profile.drives import uniform

PERIOD = 0.005


@pytest.fixture(scope="module")
def hasty():
    """A motion that jumps to the full voltage, and back."""
    wanted = np.concatenate([np.full(200, 3.0), np.zeros(100)])
    return drive_along(uniform(), wanted, PERIOD)


@pytest.mark.parametrize("window", [1, 5, 25, 50])
def test_smoothing_keeps_the_distance(hasty, window):
    voltage = smoothed(uniform(), hasty, window)
    smooth = drive_open_loop(uniform(), voltage, PERIOD)
    assert smooth.position[-1] == pytest.approx(hasty.position[-1], abs=2e-3)
    assert smooth.velocity[-1] == pytest.approx(0.0, abs=1e-3)


def test_a_window_of_one_changes_nothing(hasty):
    voltage = smoothed(uniform(), hasty, 1)
    moving = hasty.velocity[:-1] > 1e-9
    np.testing.assert_allclose(voltage.numpy()[moving], hasty.voltage[moving], atol=1e-12)


@pytest.mark.parametrize("window", [5, 25])
def test_voltages_change_no_faster_than_the_window_allows(hasty, window):
    voltage = smoothed(uniform(), hasty, window)
    assert len(voltage) == len(hasty.voltage) + window - 1
    # From one extreme to the other, with the friction, over the whole window.
    assert float(torch.diff(voltage, dim=0).abs().max()) <= (24.0 + 0.4) / window + 0.4
    assert float(voltage.abs().max()) <= 12.0 + 1e-9


def test_who_stands_stays(hasty):
    rest = drive_along(uniform(), np.zeros(10), PERIOD)
    assert float(smoothed(uniform(), rest, 5).abs().max()) == 0.0


def test_a_gentle_motion_is_hardly_changed():
    times = PERIOD * np.arange(1, 601)
    gentle = drive_along(uniform(), trapezoid(3.0, 1.5, 1.5).velocities(times), PERIOD)
    smooth = drive_open_loop(uniform(), smoothed(uniform(), gentle, 25), PERIOD)
    late = 12 * PERIOD  # half of the window
    shifted = np.interp(smooth.time - late, gentle.time, gentle.velocity)
    np.testing.assert_allclose(smooth.velocity, shifted, atol=0.06)
