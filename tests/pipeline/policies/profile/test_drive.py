import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from simgap.policies.profile.drive import Drive
from tests.pipeline.policies.profile.drives import uniform

speeds = st.floats(-3.0, 3.0).filter(lambda value: value == 0.0 or abs(value) > 1e-3)
voltages = st.floats(-12.0, 12.0)
periods = st.floats(1e-3, 0.5)


def of(value):
    return torch.full((4,), value, dtype=torch.float64)


def integrated(velocity, voltage, period, static, speed, acceleration):
    """Integrate one direction of motion at a time; a wheel at rest stays unless the voltage overcomes friction."""
    position, left = 0.0, period
    for _ in range(2):
        if velocity == 0.0 and abs(voltage) <= static:
            return 0.0, position
        sign = np.sign(velocity) if velocity else np.sign(voltage)

        def rate(_, state, sign=sign):
            return [state[1], (voltage - static * sign - speed * state[1]) / acceleration]

        def stop(_, state, sign=sign):
            return state[1] * sign + 1e-12

        stop.terminal, stop.direction = True, -1.0
        found = solve_ivp(rate, (0.0, left), [position, velocity], events=stop, rtol=1e-10, atol=1e-12)
        position, velocity = found.y[:, -1]
        left -= found.t[-1]
        if left <= 1e-12:
            break
        velocity = 0.0
    return velocity, position


@given(speeds, voltages, periods)
def test_a_period_is_exact_through_a_stop_and_a_reversal(velocity, voltage, period):
    drive = uniform()
    reached, distance = drive.advance(of(velocity), of(voltage), period)
    expected = integrated(velocity, voltage, period, 0.4, 3.78, 1.06)
    assert float(reached[0]) == pytest.approx(expected[0], abs=1e-6)
    assert float(distance[0]) == pytest.approx(expected[1], abs=1e-6)


@given(speeds, speeds, periods)
def test_the_feedforward_brings_a_wheel_to_the_speed_that_is_wanted(velocity, desired, period):
    """Where it is not asked to turn round, and friction would not hold it."""
    if velocity * desired < 0.0:
        return
    drive = uniform()
    voltage = drive.feedforward(of(velocity), of(desired), period)
    if float(voltage[0]) * desired <= 0.0 and velocity == 0.0:
        return
    reached, _ = drive.advance(of(velocity), voltage, period)
    assert float(reached[0]) == pytest.approx(desired, abs=1e-9)


@given(speeds, voltages, periods, periods)
def test_two_periods_are_one_long_one(velocity, voltage, first, second):
    drive = uniform()
    halfway, begun = drive.advance(of(velocity), of(voltage), first)
    end, ended = drive.advance(halfway, of(voltage), second)
    whole, distance = drive.advance(of(velocity), of(voltage), first + second)
    torch.testing.assert_close(end, whole, atol=1e-9, rtol=0)
    torch.testing.assert_close(begun + ended, distance, atol=1e-9, rtol=0)


@given(speeds, st.floats(-40.0, 40.0), st.floats(0.5, 20.0))
def test_no_voltage_within_the_limits_exceeds_battery_or_grip(velocity, voltage, grip):
    drive = uniform(acceleration_limit=grip)
    applied = drive.within_limits(of(velocity), of(voltage))
    assert float(applied.abs().max()) <= 12.0
    reached, _ = drive.advance(of(velocity), applied, 1e-5)
    pulled = float(reached[0] - velocity) / 1e-5
    # A robot that is faster than its battery can drive it is slowed down by more than was asked.
    assert abs(0.4 * np.sign(velocity) + 3.78 * velocity) > 12.0 or abs(pulled) <= grip * (1.0 + 1e-3) + 1e-6


def test_friction_holds_a_wheel_at_rest():
    drive = uniform(static=0.4)
    velocity, distance = drive.advance(of(0.0), of(0.39), 1.0)
    assert velocity.tolist() == distance.tolist() == [0.0] * 4


def test_from_rest_to_rest_the_voltage_beyond_friction_says_how_far_it_went():
    """∫(V − kS) dt = kV·y, whatever kA is."""
    drive = Drive(of(0.4), of(3.78), torch.tensor([0.5, 1.0, 2.0, 4.0], dtype=torch.float64))
    velocity, distance = drive.advance(of(0.0), of(9.0), 0.7)
    time = drive.time_constant * torch.log1p(-velocity / ((0.0 - 0.4) / 3.78))
    velocity, rest = drive.advance(velocity, of(0.0), 100.0)
    assert velocity.tolist() == [0.0] * 4
    torch.testing.assert_close(distance + rest, (8.6 * 0.7 - 0.4 * time) / 3.78)
