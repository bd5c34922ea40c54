"""What every mechanism answers, and what each of them does in cases that can be worked out by hand."""

import math

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from pipeline.physics import rotations
from pipeline.platforms.mechanisms import mechanism_of
from pipeline.platforms.swerve_mechanism import chassis_velocity_from_wheels
from tests.pipeline.platforms.machines import JOINT, MACHINES, QUADROTOR, SWERVE, some_signals

KINDS = pytest.mark.parametrize("kind", list(MACHINES))
SEEDS = st.integers(0, 10**6)


@KINDS
def test_every_channel_is_balanced_and_nothing_else(kind):
    mechanism = mechanism_of(MACHINES[kind])
    constants = mechanism.constants()
    signals = mechanism.actuate(some_signals(kind, (3, 5), seed=1), constants)
    names = {channel.name for channel in mechanism.channels}
    assert set(mechanism.wrench(signals, constants)) == names
    assert set(mechanism.momentum(signals, constants)) == names
    assert set(mechanism.inertia(constants)) == names
    assert set(mechanism.inertial(signals, constants)) <= names


@KINDS
@pytest.mark.parametrize("shape", [(), (7,), (1,), (2, 3), (2, 1, 4)])
@pytest.mark.parametrize("dtype", [torch.float32, torch.float64])
def test_leading_dimensions_and_precision_are_free(kind, shape, dtype):
    mechanism = mechanism_of(MACHINES[kind])
    constants = mechanism.constants()
    signals = mechanism.actuate(some_signals(kind, shape, seed=2, dtype=dtype), constants)
    parts = (mechanism.wrench, mechanism.inertial, mechanism.momentum)
    for values in (part(signals, constants) for part in parts):
        for value in values.values():
            assert value.shape == shape
            assert value.dtype == dtype


@KINDS
@given(seed=SEEDS)
def test_inertia_is_momentum_per_velocity(kind, seed):
    mechanism = mechanism_of(MACHINES[kind])
    constants = mechanism.constants()
    signals = some_signals(kind, (), seed)
    velocity = {
        "quadrotor": lambda: torch.cat([signals["velocity"], signals["body_rate"]]),
        "swerve": lambda: torch.cat([signals["chassis_velocity"], signals["steer_velocity"]]),
        "joint": lambda: signals["velocity"][None],
    }[kind]()
    momentum, inertia = mechanism.momentum(signals, constants), mechanism.inertia(constants)
    for channel, speed in zip(mechanism.channels, velocity, strict=True):
        torch.testing.assert_close(momentum[channel.name], inertia[channel.name] * speed)


@given(seed=SEEDS)
def test_the_turning_frame_of_a_quadrotor_neither_makes_nor_takes_energy(seed):
    """But for the weight, whose power is that of the height it climbs."""
    mechanism = mechanism_of(QUADROTOR)
    constants = mechanism.constants()
    signals = some_signals("quadrotor", (), seed)
    inertial = mechanism.inertial(signals, constants)
    force, torque = (
        torch.stack([inertial[f"{stem}_{axis}"] for axis in "xyz"]) for stem in ("force", "torque")
    )
    climb = rotations.rotate(signals["attitude"], signals["velocity"])[2]
    torch.testing.assert_close(
        force @ signals["velocity"], -constants["gravity"] * climb, atol=1e-9, rtol=1e-9
    )
    assert abs(float(torque @ signals["body_rate"])) < 1e-9


def test_rotors_lift_roll_pitch_and_yaw_as_their_places_say():
    mechanism = mechanism_of(QUADROTOR)
    constants = mechanism.constants()
    hover = torch.full((4,), QUADROTOR.hover_rotor_speed, dtype=torch.float64)
    wrench = mechanism.wrench({"rotor_speed": hover}, constants)
    assert float(wrench["force_z"]) == pytest.approx(QUADROTOR.gravity)
    for channel in ("force_x", "force_y", "torque_x", "torque_y", "torque_z"):
        assert abs(float(wrench[channel])) < 1e-12
    stronger = {
        "torque_x": (2, 3),  # the left rotors lift the left side: roll to the right, about +x
        "torque_y": (1, 2),  # the rear rotors lift the tail: nose down, about +y
        "torque_z": (1, 3),  # those whose reaction is about +z
    }
    for channel, rotors in stronger.items():
        speed = hover.clone()
        speed[list(rotors)] += 50.0
        wrench = mechanism.wrench({"rotor_speed": speed}, constants)
        assert float(wrench[channel]) > 0
        for other in set(stronger) - {channel}:
            assert abs(float(wrench[other])) < 1e-12


def test_a_rotor_follows_its_command_unless_its_speed_is_known():
    mechanism = mechanism_of(QUADROTOR)
    command = torch.tensor([0.0, 0.5, 1.0, 0.25], dtype=torch.float64)
    actuated = mechanism.actuate({"motor_command": command}, mechanism.constants())
    torch.testing.assert_close(actuated["rotor_speed"], QUADROTOR.motor_speed_max * command)
    known = {"motor_command": command, "rotor_speed": 3.0 * command}
    torch.testing.assert_close(mechanism.actuate(known, mechanism.constants())["rotor_speed"], 3.0 * command)


@given(speed=st.floats(-2.0, 2.0))
def test_motors_stop_pulling_at_their_free_speed(speed):
    """And pull with the stall torque at standstill, on a straight line between."""
    mechanism = mechanism_of(SWERVE)
    motor = SWERVE.drive.motor
    voltage = torch.full((4,), motor.nominal_voltage, dtype=torch.float64)
    turning = torch.full((4,), speed * motor.free_speed, dtype=torch.float64)
    signals = {
        "drive_voltage": voltage,
        "steer_voltage": voltage,
        "drive_velocity": turning,
        "steer_velocity": turning / SWERVE.steer.gear_ratio,
    }
    actuated = mechanism.actuate(signals, mechanism.constants())
    for group, axis in (("drive", SWERVE.drive), ("steer", SWERVE.steer)):
        expected = axis.gear_ratio * motor.stall_torque * (1.0 - speed)
        assert float(actuated[f"{group}_torque"][0]) == pytest.approx(expected, abs=1e-9)


def test_the_motor_of_a_joint_gives_stall_torque_and_stops_pulling_at_free_speed():
    mechanism, motor = mechanism_of(JOINT), JOINT.motor
    constant = motor.torque_constant * motor.gear_ratio
    velocity = torch.tensor([0.0, 6.0 / constant], dtype=torch.float64)
    signals = {"voltage": torch.tensor(6.0, dtype=torch.float64), "velocity": velocity}
    effort = mechanism.actuate(signals, mechanism.constants())["effort"]
    torch.testing.assert_close(
        effort, torch.tensor([6.0 * constant / motor.resistance, 0.0], dtype=torch.float64)
    )


@given(seed=SEEDS)
def test_wheels_pointing_along_the_motion_tell_the_chassis_velocity(seed):
    """Forward kinematics inverts inverse kinematics."""
    twist = some_signals("swerve", (5,), seed)["chassis_velocity"]
    x, y, yaw = twist.unbind(-1)
    places = torch.tensor(SWERVE.module_positions, dtype=torch.float64)
    along_x = x[:, None] - yaw[:, None] * places[:, 1]
    along_y = y[:, None] + yaw[:, None] * places[:, 0]
    motor_speed = torch.hypot(along_x, along_y) * SWERVE.drive.gear_ratio / SWERVE.wheel_radius
    found = chassis_velocity_from_wheels(motor_speed, torch.atan2(along_y, along_x), SWERVE)
    torch.testing.assert_close(found, twist)


def test_hover_rotor_speed_carries_the_weight():
    lift = 4 * QUADROTOR.thrust_coefficient * QUADROTOR.hover_rotor_speed**2
    assert math.isclose(lift, QUADROTOR.mass * QUADROTOR.gravity)
