"""What every mechanism answers, and what each of them does in cases that can be worked out by hand."""

import math

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from simgap.physics import rotations
from simgap.platforms.mechanisms import mechanism_of
from simgap.platforms.swerve_constraint import along_the_wheels
from simgap.platforms.swerve_mechanism import MEASURED, twist_from_wheels
from simgap.platforms.swerve_slip import CREEP, GIVES_WAY, SLIDING
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
    wheels = {"drive_velocity": motor_speed, "steer_angle": torch.atan2(along_y, along_x)}
    wheels["steer_velocity"] = torch.zeros_like(motor_speed)
    found = twist_from_wheels(wheels, mechanism_of(SWERVE).constants())
    torch.testing.assert_close(found, twist)


def test_hover_rotor_speed_carries_the_weight():
    lift = 4 * QUADROTOR.thrust_coefficient * QUADROTOR.hover_rotor_speed**2
    assert math.isclose(lift, QUADROTOR.mass * QUADROTOR.gravity)


def rolling_signals(seed: int) -> dict[str, torch.Tensor]:
    """Return a swerve drive whose wheels point along its motion and roll as fast, the motion measured."""
    signals = some_signals("swerve", (5,), seed)
    twist = signals["chassis_velocity"]
    x, y, yaw = twist.unbind(-1)
    places = torch.tensor(SWERVE.module_positions, dtype=torch.float64)
    along_x, along_y = x[:, None] - yaw[:, None] * places[:, 1], y[:, None] + yaw[:, None] * places[:, 0]
    motor = torch.hypot(along_x, along_y) * SWERVE.drive.gear_ratio / SWERVE.wheel_radius
    angle = torch.atan2(along_y, along_x)
    return signals | {"drive_velocity": motor, "steer_angle": angle, MEASURED: twist}


@given(seed=SEEDS)
def test_wheels_that_roll_agree_with_the_measured_motion(seed):
    mechanism = mechanism_of(SWERVE)
    signals = rolling_signals(seed)
    readings = mechanism.readings(signals, mechanism.constants())
    assert [channel.name for channel in mechanism.channels_of(signals)[7:]] == list(readings)
    for measured, predicted in readings.values():
        torch.testing.assert_close(measured, predicted, rtol=1e-3, atol=1e-3)


@given(seed=SEEDS, share=st.floats(0.7, 1.3))
def test_a_smaller_wheel_has_to_turn_faster(seed, share):
    mechanism = mechanism_of(SWERVE)
    constants = mechanism.constants()
    smaller = constants | {"wheel_radius": share * constants["wheel_radius"]}
    for measured, predicted in list(mechanism.readings(rolling_signals(seed), smaller).values())[:4]:
        torch.testing.assert_close(measured, share * predicted)


@given(seed=SEEDS, offset=st.floats(-0.3, 0.3))
def test_motion_across_the_wheels_is_all_that_disagrees_with_them(seed, offset):
    """All modules turned by one angle turn the motion of a robot that does not rotate by as much."""
    mechanism = mechanism_of(SWERVE)
    constants = mechanism.constants()
    twist = some_signals("swerve", (5,), seed)["chassis_velocity"] * torch.tensor([1.0, 1.0, 0.0])
    course = torch.atan2(twist[:, 1], twist[:, 0])
    along = along_the_wheels(twist, (course + offset)[:, None].expand(5, 4), constants)
    turned = torch.stack([torch.cos(course + offset), torch.sin(course + offset)], -1)
    expected = twist[:, :2].norm(dim=-1, keepdim=True) * math.cos(offset) * turned
    torch.testing.assert_close(along[:, :2], expected, rtol=1e-3, atol=1e-3)
    torch.testing.assert_close(along[:, 2], torch.zeros(5, dtype=torch.float64), rtol=0, atol=2e-3)


@given(seed=SEEDS, slip=st.floats(0.0, 100.0))
def test_only_a_wheel_that_slides_may_turn_otherwise_and_creep_is_no_sliding(seed, slip):
    """What is believed of a slip grows from none at the creep to all of it."""
    mechanism = mechanism_of(SWERVE)
    constants = mechanism.constants()
    signals = rolling_signals(seed)
    faster = signals["drive_velocity"] + slip
    sliding = torch.tensor([0.0, 1.0, 0.0, 0.0], dtype=torch.float64).expand(5, 4)
    readings = mechanism.readings(signals | {"drive_velocity": faster, SLIDING: sliding}, constants)
    per_speed = SWERVE.drive.gear_ratio / SWERVE.wheel_radius
    creep = GIVES_WAY * torch.hypot(signals["drive_velocity"][:, 1], torch.tensor(CREEP * per_speed).double())
    left = (readings["rolling_2"][0] - readings["rolling_2"][1]).abs()
    whole = torch.full_like(left, slip)
    expected = torch.where(whole <= creep, whole, creep.square() / whole)
    torch.testing.assert_close(left, expected, rtol=1e-5, atol=1e-5)
    held = readings["rolling_1"][0] - readings["rolling_1"][1]
    torch.testing.assert_close(held, torch.full_like(held, slip), rtol=1e-6, atol=1e-6)
