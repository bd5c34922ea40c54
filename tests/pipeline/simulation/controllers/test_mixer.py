from dataclasses import replace

import hypothesis.strategies as st
import pytest
import torch
from hypothesis import given

from simgap.errors import InputError
from simgap.platforms import Quadrotor
from simgap.simulation.controllers.mixer import allocation, distribution, mix
from tests.pipeline.platforms.machines import QUADROTOR

MOST = 8.75
ARM = st.floats(0.05, 0.2)
TORQUES = st.lists(st.floats(-5.0, 5.0), min_size=3, max_size=3).filter(
    lambda torque: max(map(abs, torque)) > 1e-3
)


def built(front: float, back: float, side: float) -> Quadrotor:
    corners = ((front, -side, 0.0), (-back, -side, 0.0), (-back, side, 0.0), (front, side, 0.0))
    return replace(QUADROTOR, rotor_positions=corners)


def mixed(platform: Quadrotor, thrust: float, torque: list[float]) -> tuple[torch.Tensor, torch.Tensor]:
    """Return the thrust of each rotor and the torque that results."""
    spread = distribution(platform)
    least = 0.0121 * MOST * spread[:, 0]
    wanted = torch.tensor(torque, dtype=torch.float64)
    each = mix(torch.tensor(thrust, dtype=torch.float64), wanted, spread, least, MOST)
    return each, allocation(platform) @ each


@given(ARM, ARM, ARM, st.floats(8.0, 14.0), st.lists(st.floats(-0.01, 0.01), min_size=3, max_size=3))
def test_what_is_wanted_results_where_no_rotor_saturates(front, back, side, thrust, torque):
    _, reached = mixed(built(front, back, side), thrust, torque)
    assert reached.tolist() == pytest.approx([thrust, *torque], abs=1e-9)


@given(ARM, ARM, ARM, st.floats(-5.0, 60.0), TORQUES)
def test_saturation_keeps_the_direction_of_the_torque(front, back, side, thrust, torque):
    each, reached = mixed(built(front, back, side), thrust, torque)
    assert (each >= 0).all()
    assert (each <= MOST * (1 + 1e-12)).all()
    wanted = torch.tensor(torque, dtype=torch.float64)
    share = float(reached[1:] @ wanted) / float(wanted @ wanted)
    assert 0 < share <= 1 + 1e-9
    assert reached[1:].tolist() == pytest.approx((share * wanted).tolist(), abs=1e-9)


def test_more_torque_than_thrust_allows_raises_the_thrust():
    each, reached = mixed(QUADROTOR, 0.5, [0.3, 0.0, 0.0])
    assert float(reached[0]) > 0.5
    assert reached[1:].tolist() == pytest.approx([0.3, 0.0, 0.0], abs=1e-12)
    assert float(each.min()) > 0


def test_full_thrust_with_torque_scales_all_rotors_down():
    each, reached = mixed(QUADROTOR, 4 * MOST, [0.5, 0.0, 0.0])
    assert float(each.max()) == pytest.approx(MOST)
    assert 0 < float(reached[1]) < 0.5


def test_rotors_that_cannot_turn_the_body_are_refused():
    with pytest.raises(InputError, match="every axis"):
        distribution(built(0.0, 0.0, 0.1))
    corners = ((0.2, 0.1, 0.0), (0.1, 0.1, 0.0), (0.1, 0.2, 0.0), (0.3, 0.3, 0.0))
    aside = replace(QUADROTOR, rotor_positions=corners)
    with pytest.raises(InputError, match="without turning"):
        distribution(aside)
