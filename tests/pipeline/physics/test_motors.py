import math

import hypothesis.strategies as st
import pytest
import torch
from hypothesis import given

from simgap.physics import motors


@given(st.floats(-10, 10), st.floats(-10, 10), st.floats(1e-3, 1.0), st.floats(1e-4, 1.0))
def test_first_order_lag_is_exact(start, target, time_constant, dt):
    end = motors.first_order_lag(
        torch.tensor(start, dtype=torch.float64), torch.tensor(target, dtype=torch.float64), time_constant, dt
    )
    assert float(end) == pytest.approx(
        target + (start - target) * math.exp(-dt / time_constant), rel=1e-12, abs=1e-12
    )


def test_two_half_steps_of_the_lag_are_one_step():
    start, target = torch.tensor([3.0]), torch.tensor([-1.0])
    half = motors.first_order_lag(start, target, 0.05, 0.01)
    torch.testing.assert_close(
        motors.first_order_lag(half, target, 0.05, 0.01), motors.first_order_lag(start, target, 0.05, 0.02)
    )


def test_stalled_motor_draws_voltage_over_resistance():
    torch.testing.assert_close(
        motors.current(torch.tensor(12.0), torch.tensor(0.0), 0.1, 0.02), torch.tensor(120.0)
    )


def test_motor_balances_electrical_and_mechanical_power():
    voltage, speed = torch.tensor(11.0), torch.tensor(300.0)
    drawn = motors.current(voltage, speed, 0.12, 0.02)
    heat = 0.12 * drawn**2
    torch.testing.assert_close(voltage * drawn, heat + motors.torque(drawn, 0.02) * speed)


def test_gradients():
    values = [torch.tensor([x], dtype=torch.float64, requires_grad=True) for x in (0.4, 1.0, 0.05)]
    assert torch.autograd.gradcheck(lambda x, u, tau: motors.first_order_lag(x, u, tau, 0.01), values)
