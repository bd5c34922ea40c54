import hypothesis.strategies as st
import pytest
import torch
from hypothesis import given

from simgap.physics.speed_controllers import SpeedMap, calibrated_speed_map, motor_speed, steady_speed

SPEED_MAX, HOVER, VOLTAGE, EFFICIENCY = 2366.4, 1168.6, 14.8, 0.75


def grid() -> tuple[torch.Tensor, torch.Tensor]:
    return torch.meshgrid(
        torch.linspace(0.05, 1.0, 20, dtype=torch.float64),
        torch.linspace(0.89, 1.11, 9, dtype=torch.float64),
        indexing="ij",
    )


def speed(throttle: torch.Tensor, voltage: torch.Tensor) -> torch.Tensor:
    speed_map = calibrated_speed_map(SPEED_MAX, HOVER, VOLTAGE, EFFICIENCY)
    return steady_speed(throttle[..., None], voltage, speed_map)[..., 0]


def test_hover_and_full_throttle_are_met_at_nominal_voltage():
    throttle = torch.tensor([HOVER / SPEED_MAX, 1.0], dtype=torch.float64)
    assert speed(throttle, torch.full_like(throttle, VOLTAGE)).tolist() == pytest.approx([HOVER, SPEED_MAX])


def test_the_map_follows_the_motor_within_a_hundredth_of_its_greatest_speed():
    throttle, ratio = grid()
    wanted = SPEED_MAX * motor_speed(throttle, ratio, EFFICIENCY)
    assert float((speed(throttle, VOLTAGE * ratio) - wanted).abs().max()) < 0.01 * SPEED_MAX


def test_speed_rises_with_throttle_and_voltage():
    throttle, ratio = grid()
    reached = speed(throttle, VOLTAGE * ratio)
    assert (reached.diff(dim=0) > 0).all()
    assert (reached[3:].diff(dim=1) > 0).all()  # of throttles that fly


@given(st.floats(0.01, 1.0), st.floats(0.7, 1.3), st.floats(0.3, 0.95))
def test_the_motor_takes_the_voltage_that_is_applied(throttle, ratio, efficiency):
    given_to = torch.tensor([throttle, ratio], dtype=torch.float64)
    share = motor_speed(given_to[0], given_to[1], efficiency)
    taken = (1 - efficiency) * share**2 + efficiency * share
    applied = ((1 - efficiency) * throttle**2 + efficiency * throttle) * ratio
    assert float(taken) == pytest.approx(applied, rel=1e-9)


def test_a_rotor_never_turns_backwards():
    still = steady_speed(
        torch.tensor([[0.01] * 4]), torch.tensor([5.0]), SpeedMap(-100.0, 0.0, 0.0, 1.0, 0.0)
    )
    assert still.tolist() == [[0.0] * 4]


def test_gradients():
    speed_map = calibrated_speed_map(SPEED_MAX, HOVER, VOLTAGE, EFFICIENCY)
    throttle = torch.tensor([[0.2, 0.5, 0.8, 0.9]], dtype=torch.float64, requires_grad=True)
    voltage = torch.tensor([14.0], dtype=torch.float64, requires_grad=True)
    assert torch.autograd.gradcheck(lambda u, v: steady_speed(u, v, speed_map), (throttle, voltage))
