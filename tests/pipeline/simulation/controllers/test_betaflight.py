import math

import pytest
import torch

from simgap.errors import InputError
from simgap.simulation.controllers import Betaflight
from simgap.simulation.controllers.mixer import allocation
from tests.pipeline.platforms.machines import QUADROTOR

DT = 0.002
HOVER = torch.tensor([[9.81, 0.0, 0.0, 0.0]], dtype=torch.float64)
STILL = torch.zeros(1, 3, dtype=torch.float64)


def acceleration(throttle: torch.Tensor) -> torch.Tensor:
    """Return the angular acceleration that throttles ask of the platform's nominal rotors."""
    each = QUADROTOR.thrust_coefficient * (QUADROTOR.motor_speed_max * throttle) ** 2
    torque = (allocation(QUADROTOR) @ each[..., None])[..., 1:, 0]
    return torque / torch.tensor(QUADROTOR.inertia, dtype=torch.float64)


def controller(**gains) -> Betaflight:
    none = (0.0, 0.0, 0.0)
    chosen = {"proportional": none, "integral": none, "derivative": none} | gains
    return Betaflight(QUADROTOR, **chosen)


def test_a_hovering_throttle_carries_the_weight():
    throttle, _ = Betaflight.tuned(QUADROTOR, 0.033).command(STILL, HOVER, None, DT)
    each = QUADROTOR.thrust_coefficient * (QUADROTOR.motor_speed_max * throttle) ** 2
    assert float(each.sum()) == pytest.approx(QUADROTOR.mass * 9.81)
    assert float(throttle.std()) == pytest.approx(0.0, abs=1e-12)


def test_the_error_is_met_in_proportion():
    reference = HOVER + torch.tensor([[0.0, 0.3, -0.2, 0.1]], dtype=torch.float64)
    throttle, _ = controller(proportional=(20.0, 30.0, 10.0)).command(STILL, reference, None, DT)
    assert acceleration(throttle)[0].tolist() == pytest.approx([6.0, -6.0, 1.0])


def test_the_derivative_sees_the_measurement_and_not_the_reference():
    damping = controller(derivative=(1.0, 1.0, 1.0))
    throttle, memory = damping.command(STILL, HOVER, None, DT)
    kicked = HOVER + torch.tensor([[0.0, 8.0, -8.0, 4.0]], dtype=torch.float64)
    after_reference, _ = damping.command(STILL, kicked, memory, DT)
    torch.testing.assert_close(after_reference, throttle)
    turned = torch.tensor([[0.01, 0.0, 0.0]], dtype=torch.float64)
    after_turn, _ = damping.command(turned, HOVER, memory, DT)
    share = 1.0 - math.exp(-2.0 * math.pi * damping.derivative_cutoff * DT)
    assert acceleration(after_turn)[0].tolist() == pytest.approx([-share * 0.01 / DT, 0.0, 0.0], abs=1e-9)


def test_the_integral_grows_with_the_error_up_to_its_limit():
    integrating = controller(integral=(10.0, 10.0, 10.0))
    reference = HOVER + torch.tensor([[0.0, 1.0, 0.0, 0.0]], dtype=torch.float64)
    memory = None
    for _ in range(50):
        throttle, memory = integrating.command(STILL, reference, memory, DT)
    assert acceleration(throttle)[0].tolist() == pytest.approx([10.0 * 50 * DT, 0.0, 0.0], abs=1e-9)
    memory["integral"] = torch.full_like(STILL, 99.999)
    _, memory = integrating.command(STILL, reference * 100, memory, DT)
    assert float(memory["integral"][0, 0]) == integrating.integral_limit


def test_the_integral_is_reset_while_the_throttle_is_cut():
    integrating = controller(integral=(10.0, 10.0, 10.0))
    turning = torch.tensor([[0.0, 3.0, 2.0, 1.0]], dtype=torch.float64)
    _, memory = integrating.command(STILL, HOVER + turning, None, DT)
    assert float(memory["integral"].abs().min()) > 0
    throttle, memory = integrating.command(STILL, turning, memory, DT)
    assert memory["integral"].tolist() == [[0.0, 0.0, 0.0]]
    assert float(throttle.max()) == pytest.approx(integrating.idle)
    _, memory = integrating.command(STILL, HOVER + turning, memory, DT)
    assert float(memory["integral"][0, 2]) == pytest.approx(10.0 * 1.0 * DT)


def test_rates_answer_as_the_tuning_says():
    """Against the exact step response of time_constant·ω̈ + 2·ω̇ + P·ω = P·reference, with the integral off."""
    lag, damping, small = 0.033, 0.7, 1e-4
    tuned = Betaflight.tuned(QUADROTOR, lag, damping)
    tuned = Betaflight(
        QUADROTOR, tuned.proportional, (0.0, 0.0, 0.0), tuned.derivative, derivative_cutoff=1e5
    )
    rate, acting, memory = 0.0, 0.0, None
    for _ in range(round(0.06 / small)):
        measured = torch.tensor([[rate, 0.0, 0.0]], dtype=torch.float64)
        reference = HOVER + torch.tensor([[0.0, 0.5, 0.0, 0.0]], dtype=torch.float64)
        throttle, memory = tuned.command(measured, reference, memory, small)
        acting += (float(acceleration(throttle)[0, 0]) - acting) * small / lag
        rate += small * acting
    natural = 1.0 / (damping * lag)
    turning = natural * math.sqrt(1 - damping**2)
    decay = math.exp(-damping * natural * 0.06)
    exact = 0.5 * (
        1 - decay * (math.cos(turning * 0.06) + damping * natural / turning * math.sin(turning * 0.06))
    )
    assert rate == pytest.approx(exact, rel=0.02)


def test_motors_without_lag_are_refused():
    with pytest.raises(InputError, match="positive"):
        Betaflight.tuned(QUADROTOR, 0.0)
