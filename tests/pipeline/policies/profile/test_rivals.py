import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from simgap.policies.profile.motion import drive_along
from simgap.policies.profile.reference import trapezoid
from simgap.policies.profile.rivals import fastest_s_curve, fastest_trapezoid, peak_voltage
from simgap.policies.profile.time_optimal import time_optimal
from tests.pipeline.policies.profile.drives import uniform


def test_the_peak_voltage_of_a_trapezoid_is_at_the_end_of_its_acceleration():
    asked = peak_voltage(uniform(0.4, 3.78, 1.06), trapezoid(3.0, 1.5, 2.0))
    assert asked == pytest.approx(0.4 + 3.78 * 1.5 + 1.06 * 2.0, abs=1e-6)


def test_the_search_finds_the_trapezoid_of_the_closed_form():
    """At each acceleration the highest speed has kS + kV·v + kA·a = 12 V."""

    def duration(acceleration):
        return trapezoid(3.0, (12.0 - 0.4 - 1.06 * acceleration) / 3.78, acceleration).duration

    exact = minimize_scalar(duration, bounds=(0.5, 9.0), method="bounded", options={"xatol": 1e-8})
    found, limits = fastest_trapezoid(uniform(), 3.0, 5.0)
    assert found.duration == pytest.approx(exact.fun, rel=1e-5)
    assert limits["acceleration"] == pytest.approx(exact.x, rel=1e-2)


@pytest.mark.parametrize("fastest", [fastest_trapezoid, fastest_s_curve])
@pytest.mark.parametrize("speed", [1.0, 3.0])
def test_the_fastest_profile_is_followed_within_the_voltage_and_behind_the_bound(fastest, speed):
    drive, period = uniform(), 0.005
    reference, limits = fastest(drive, 3.0, speed)
    assert limits["speed"] <= speed
    assert peak_voltage(drive, reference) <= 12.0 + 1e-6
    times = period * np.arange(1, 2 + round(reference.duration / period))
    followed = drive_along(drive, reference.velocities(times), period)
    np.testing.assert_allclose(followed.velocity[1:], reference.velocities(times), atol=0.03)
    assert reference.duration > time_optimal(drive, 3.0, speed).time[-1]


def test_no_profile_asks_more_than_the_grip():
    drive = uniform(acceleration_limit=1.7)
    for fastest in (fastest_trapezoid, fastest_s_curve):
        reference, limits = fastest(drive, 3.0, 3.0)
        steepest = np.abs(reference.acceleration(reference.acceleration.x)).max()
        assert steepest <= limits["acceleration"] * (1.0 + 1e-9) <= 1.7 * (1.0 + 1e-8)


def test_an_s_curve_that_gives_way_as_the_speed_rises_is_no_slower_than_the_trapezoid():
    trapezoidal, _ = fastest_trapezoid(uniform(), 3.0, 3.0)
    smooth, _ = fastest_s_curve(uniform(), 3.0, 3.0)
    assert smooth.duration <= trapezoidal.duration + 1e-4
