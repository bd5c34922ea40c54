"""Inverse and forward kinematics of a swerve drive undo each other, and modules never turn further than they need."""

import math

import torch
from hypothesis import given
from hypothesis import strategies as st

from simgap.platforms.swerve_kinematics import (
    chassis_twist,
    heading_of,
    lateral_matrix,
    lateral_matrix_rate,
    module_states,
    module_velocities,
    rolling_speed,
    wheel_direction,
)
from tests.pipeline.platforms.machines import SWERVE

POSITIONS = torch.tensor(SWERVE.module_positions, dtype=torch.float64)
COMPONENT = st.floats(-20.0, 20.0, allow_subnormal=False)
TWISTS = st.tuples(COMPONENT, COMPONENT, COMPONENT).map(lambda entries: torch.tensor(entries).double())
ANGLES = st.lists(st.floats(-30.0, 30.0), min_size=4, max_size=4).map(
    lambda entries: torch.tensor(entries).double()
)


@given(twist=TWISTS)
def test_forward_kinematics_inverts_inverse_kinematics(twist):
    found = chassis_twist(module_velocities(twist, POSITIONS), POSITIONS)
    torch.testing.assert_close(found, twist, rtol=1e-12, atol=1e-12)


@given(velocities=st.lists(COMPONENT, min_size=8, max_size=8))
def test_what_forward_kinematics_leaves_over_is_at_right_angles_to_every_twist(velocities):
    """That is least squares."""
    modules = torch.tensor(velocities).double().reshape(4, 2)
    left = modules - module_velocities(chassis_twist(modules, POSITIONS), POSITIONS)
    for twist in torch.eye(3, dtype=torch.float64):
        assert abs(float((left * module_velocities(twist, POSITIONS)).sum())) < 1e-10


@given(twist=TWISTS, angle=ANGLES)
def test_module_states_give_the_twist_with_no_more_than_a_quarter_turn(twist, angle):
    turned, speed = module_states(twist, POSITIONS, angle)
    wanted = module_velocities(twist, POSITIONS)
    torch.testing.assert_close(speed[:, None] * wheel_direction(turned), wanted, rtol=1e-9, atol=1e-9)
    assert ((turned - angle).abs() <= 0.5 * math.pi + 1e-9).all()
    torch.testing.assert_close(rolling_speed(twist, turned, POSITIONS), speed, rtol=1e-9, atol=1e-9)


def test_a_module_that_does_not_move_keeps_its_angle():
    angle = torch.tensor([0.1, -2.0, 9.0, 4.0], dtype=torch.float64)
    turned, speed = module_states(torch.zeros(3, dtype=torch.float64), POSITIONS, angle)
    assert torch.equal(turned, angle)
    assert torch.equal(speed, torch.zeros_like(angle))


@given(twist=TWISTS, angle=ANGLES)
def test_wheels_that_point_along_a_motion_do_not_move_across_it(twist, angle):
    turned, _ = module_states(twist, POSITIONS, angle)
    across = lateral_matrix(turned, POSITIONS) @ twist
    torch.testing.assert_close(across, torch.zeros_like(across), rtol=0.0, atol=1e-9)


@given(angle=ANGLES, turning=ANGLES)
def test_the_rate_of_the_lateral_matrix_is_its_slope_in_time(angle, turning):
    tiny = 1e-6
    later, sooner = (lateral_matrix(angle + sign * tiny * turning, POSITIONS) for sign in (1.0, -1.0))
    slope = (later - sooner) / (2.0 * tiny)
    torch.testing.assert_close(lateral_matrix_rate(angle, turning, POSITIONS), slope, rtol=1e-6, atol=1e-6)


def test_the_heading_is_the_integral_of_the_yaw_rate_from_the_start():
    time = torch.tensor([3.0, 3.5, 4.0, 6.0], dtype=torch.float64)
    twist = torch.stack([torch.ones_like(time), torch.ones_like(time), 0.4 * time], dim=-1)
    torch.testing.assert_close(heading_of(twist, time), 0.2 * (time.square() - 9.0))
