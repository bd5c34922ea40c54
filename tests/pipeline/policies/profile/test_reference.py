import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simgap.policies.profile.reference import s_curve, trapezoid

positive = st.floats(0.05, 50.0)


def instants(reference):
    return np.linspace(0.0, reference.duration, 1001)


def check(reference, distance, speed, acceleration):
    times = instants(reference)
    assert float(reference.position(reference.duration)) == pytest.approx(distance, rel=1e-9)
    assert reference.velocity(0.0) == 0.0
    assert float(reference.velocity(reference.duration)) == pytest.approx(0.0, abs=1e-9 * speed)
    assert reference.velocity(times).min() >= -1e-9 * speed
    assert reference.velocity(times).max() <= speed * (1.0 + 1e-9)
    assert np.abs(reference.acceleration(times)).max() <= acceleration * (1.0 + 1e-9)


@given(positive, positive, positive)
def test_a_trapezoid_keeps_its_limits_and_covers_the_distance(distance, speed, acceleration):
    check(trapezoid(distance, speed, acceleration), distance, speed, acceleration)


@given(positive, positive, positive, st.floats(0.05, 500.0))
def test_an_s_curve_keeps_its_limits_and_covers_the_distance(distance, speed, acceleration, jerk):
    reference = s_curve(distance, speed, acceleration, jerk)
    check(reference, distance, speed, acceleration)
    times = instants(reference)
    steps = np.abs(np.diff(reference.acceleration(times)))
    assert steps.max() <= jerk * (times[1] - times[0]) * (1.0 + 1e-6) + 1e-9 * acceleration


@given(positive, positive, positive, st.floats(0.05, 500.0))
def test_some_limit_is_always_reached(distance, speed, acceleration, jerk):
    """A profile that reaches none of its limits could be faster."""
    reference = s_curve(distance, speed, acceleration, jerk)
    slopes = np.abs(reference.acceleration.c[0]).max()
    assert slopes == pytest.approx(jerk, rel=1e-9)
    peak = reference.velocity(reference.acceleration.x).max()
    steepest = np.abs(reference.acceleration(reference.acceleration.x)).max()
    bends = 4.0 * (distance / (2.0 * jerk)) ** (1.0 / 3.0)  # as fast as jerk alone allows
    assert (
        peak == pytest.approx(speed, rel=1e-9)
        or steepest == pytest.approx(acceleration, rel=1e-9)
        or reference.duration == pytest.approx(bends, rel=1e-9)
    )


def test_the_published_trapezoid_is_a_triangle():
    """Over 3 m at 2 m/s² the speed of 3 m/s is not reached: T = 2·√(s/a)."""
    reference = trapezoid(3.0, 3.0, 2.0)
    assert reference.duration == pytest.approx(2.0 * np.sqrt(1.5), rel=1e-12)
    assert reference.velocity(reference.duration / 2) == pytest.approx(np.sqrt(6.0), rel=1e-12)


def test_an_s_curve_of_endless_jerk_is_the_trapezoid():
    smooth, sharp = s_curve(3.0, 1.5, 2.0, 1e6), trapezoid(3.0, 1.5, 2.0)
    times = instants(sharp)
    np.testing.assert_allclose(smooth.position(times), sharp.position(times), atol=1e-5)


def test_after_its_end_a_profile_stands():
    reference = trapezoid(1.0, 1.0, 1.0)
    assert reference.velocities(np.array([0.5, reference.duration, 9.0])).tolist() == [0.5, 0.0, 0.0]
