"""Machines whose motion is known in closed form, and balances that hold along any motion."""

import math

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from simgap.effects import MeasurementEffect, effects_of
from simgap.physics import rigid_body, rotations
from simgap.platforms import Joint, JointMotor
from simgap.platforms.swerve_mechanism import twist_from_wheels
from simgap.simulation import FittedEffect, Simulator, rollout
from simgap.simulation.motion import SwerveMotion, motion_of
from tests.pipeline.platforms.machines import JOINT, MACHINES, QUADROTOR, SWERVE, some_signals

UPRIGHT = [1.0, 0.0, 0.0, 0.0]


def flight(state: list[float], rotor_speed: float, time_step: float, steps: int) -> torch.Tensor:
    initial = torch.tensor([state], dtype=torch.float64)
    command = {"rotor_speed": torch.full((1, steps, 4), rotor_speed, dtype=torch.float64)}
    return rollout(Simulator(QUADROTOR), initial, command, time_step)[0]


def joint_run(joint: Joint, initial: list[float], commands: dict[str, float], time_step: float, steps: int):
    series = {name: torch.full((1, steps), value, dtype=torch.float64) for name, value in commands.items()}
    states = rollout(Simulator(joint), torch.tensor([initial], dtype=torch.float64), series, time_step)[0]
    return torch.arange(steps + 1, dtype=torch.float64) * time_step, states[:, 0], states[:, 1]


def test_free_fall_is_a_parabola_whatever_the_attitude():
    attitude = rotations.normalize(torch.tensor([0.3, -0.5, 0.7, 0.2], dtype=torch.float64)).tolist()
    states = flight([1.0, 2.0, 3.0, *attitude, 0.5, -0.4, 2.0, 0.0, 0.0, 0.0], 0.0, 0.02, 50)
    time = torch.arange(51, dtype=torch.float64) * 0.02
    torch.testing.assert_close(states[:, 0], 1.0 + 0.5 * time)
    torch.testing.assert_close(states[:, 2], 3.0 + 2.0 * time - 0.5 * QUADROTOR.gravity * time**2)
    torch.testing.assert_close(states[:, 9], 2.0 - QUADROTOR.gravity * time)
    torch.testing.assert_close(states[:, 3:7], states[:1, 3:7].expand(51, 4))


def test_at_hover_rotor_speed_nothing_moves():
    state = [0.0, 0.0, 1.0, *UPRIGHT, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    states = flight(state, QUADROTOR.hover_rotor_speed, 0.02, 50)
    torch.testing.assert_close(states, states[:1].expand(51, 13), rtol=0.0, atol=1e-12)


def test_torque_free_tumbling_keeps_angular_momentum_and_energy():
    states = flight([0.0] * 3 + UPRIGHT + [0.0] * 3 + [4.0, -7.0, 5.0], 0.0, 0.002, 150)
    attitude, rate = states[:, 3:7], states[:, 10:13]
    inertia = torch.tensor(QUADROTOR.inertia, dtype=torch.float64)
    momentum = rigid_body.angular_momentum(attitude, rate, inertia)
    energy = rigid_body.rotational_energy(rate, inertia)
    torch.testing.assert_close(momentum, momentum[:1].expand_as(momentum), rtol=1e-8, atol=1e-10)
    torch.testing.assert_close(energy, energy[:1].expand_as(energy), rtol=1e-8, atol=0.0)
    assert float((rate[-1] - rate[0]).abs().max()) > 1.0
    torch.testing.assert_close(attitude.norm(dim=-1), torch.ones(151, dtype=torch.float64))


def test_a_motor_runs_up_exponentially_to_its_free_speed():
    joint = Joint(inertia=0.02, motor=JOINT.motor)
    constant = JOINT.motor.torque_constant * JOINT.motor.gear_ratio
    rate = constant**2 / JOINT.motor.resistance / joint.inertia
    time, position, velocity = joint_run(joint, [0.0, 0.0], {"voltage": 6.0}, 0.002, 100)
    expected = 6.0 / constant * (1.0 - torch.exp(-rate * time))
    torch.testing.assert_close(velocity, expected, rtol=1e-7, atol=1e-9)
    torch.testing.assert_close(position, 6.0 / constant * time - expected / rate, rtol=1e-7, atol=1e-8)


def test_a_sliding_axis_takes_its_motor_in_turns_per_metre():
    joint = Joint(inertia=5.0, motor=JointMotor(0.5, 0.02, gear_ratio=100.0))
    simulator = Simulator(joint, position_unit="m")
    voltage = {"voltage": torch.full((1, 100), 6.0, dtype=torch.float64)}
    states = rollout(simulator, torch.zeros(1, 2, dtype=torch.float64), voltage, 0.05)
    assert float(states[0, -1, 1]) == pytest.approx(3.0 * (1.0 - math.exp(-4.0 / 0.5 / 5.0 * 5.0)), rel=1e-6)


def test_a_pendulum_that_swings_little_is_a_clock():
    joint = Joint(inertia=0.02, gravity_torque=0.4)
    time, position, _ = joint_run(joint, [1e-4, 0.0], {"effort": 0.0}, 0.01, 100)
    torch.testing.assert_close(position, 1e-4 * torch.cos(math.sqrt(0.4 / 0.02) * time), rtol=0.0, atol=1e-10)


def test_a_spring_swings_about_where_the_effort_holds_it():
    joint = Joint(inertia=0.5, stiffness=8.0)
    time, position, velocity = joint_run(joint, [0.0, 0.0], {"effort": 2.0}, 0.01, 200)
    torch.testing.assert_close(position, 0.25 * (1.0 - torch.cos(4.0 * time)), rtol=0.0, atol=1e-7)
    torch.testing.assert_close(velocity, torch.sin(4.0 * time), rtol=0.0, atol=1e-6)


def drive(angles: list[float], voltage: float, time_step: float, steps: int) -> torch.Tensor:
    initial = torch.tensor([[0.0, 0.0, 0.0, *angles, 0.0, 0.0, 0.0, 0.0, 0.0]], dtype=torch.float64)
    volts = torch.full((1, steps, 4), voltage, dtype=torch.float64)
    commands = {"drive_voltage": volts, "steer_voltage": torch.zeros_like(volts)}
    return rollout(Simulator(SWERVE), initial, commands, time_step)[0]


def run_up(inertia_at_wheel: float, voltage: float, time: torch.Tensor) -> torch.Tensor:
    """Return the wheel speed of four motors that turn an inertia from rest, rad/s."""
    motor, ratio = SWERVE.drive.motor, SWERVE.drive.gear_ratio
    free = voltage / motor.back_emf_constant / ratio
    damping = 4.0 * ratio**2 * motor.torque_constant * motor.back_emf_constant / motor.resistance
    return free * (1.0 - torch.exp(-damping / inertia_at_wheel * time))


@pytest.mark.parametrize("heading", [0.0, 0.7, math.pi / 2])
def test_a_swerve_drive_runs_straight_up_to_speed_where_its_wheels_point(heading):
    states = drive([heading] * 4, 6.0, 0.02, 40)
    time = torch.arange(41, dtype=torch.float64) * 0.02
    speed = SWERVE.wheel_radius * run_up(SWERVE.mass * SWERVE.wheel_radius**2, 6.0, time)
    torch.testing.assert_close(states[:, 0], speed * math.cos(heading), rtol=1e-5, atol=1e-9)
    torch.testing.assert_close(states[:, 1], speed * math.sin(heading), rtol=1e-5, atol=1e-9)
    torch.testing.assert_close(states[:, 2], torch.zeros_like(time))


def test_a_swerve_drive_spins_on_the_spot_with_wheels_along_the_circle():
    angles = [math.atan2(x, -y) for x, y in SWERVE.module_positions]
    states = drive(angles, 6.0, 0.01, 60)
    time = torch.arange(61, dtype=torch.float64) * 0.01
    arm = math.hypot(*SWERVE.module_positions[0])
    inertia_at_wheel = SWERVE.inertia * (SWERVE.wheel_radius / arm) ** 2
    expected = run_up(inertia_at_wheel, 6.0, time) * SWERVE.wheel_radius / arm
    torch.testing.assert_close(states[:, 2], expected, rtol=1e-5, atol=1e-9)
    torch.testing.assert_close(states[:, :2], torch.zeros_like(states[:, :2]), rtol=0.0, atol=1e-10)


@given(seed=st.integers(0, 10**6))
def test_the_power_of_the_wheels_is_that_of_the_chassis(seed):
    """What four wheel torques do to the chassis is the transpose of how its motion turns the wheels."""
    signals = some_signals("swerve", (), seed)
    motion, mechanism = SwerveMotion(SWERVE), Simulator(SWERVE).mechanism
    rolling = motion.signals(motion.pack(signals))["drive_velocity"] / SWERVE.drive.gear_ratio
    torques = {"drive_torque": signals["drive_voltage"], "steer_torque": signals["steer_voltage"]}
    wrench = mechanism.wrench(signals | torques, mechanism.constants())
    chassis = torch.stack([wrench[f"drive_{axis}"] for axis in ("x", "y", "yaw")])
    torch.testing.assert_close(torques["drive_torque"] @ rolling, chassis @ signals["chassis_velocity"])


@given(seed=st.integers(0, 10**6))
def test_simulated_wheels_along_the_motion_tell_the_chassis_velocity(seed):
    signals = some_signals("swerve", (5,), seed)
    x, y, yaw = signals["chassis_velocity"].unbind(-1)
    places = torch.tensor(SWERVE.module_positions, dtype=torch.float64)
    along_x = x[:, None] - yaw[:, None] * places[:, 1]
    along_y = y[:, None] + yaw[:, None] * places[:, 0]
    motion = motion_of(SWERVE)
    wheels = motion.signals(motion.pack(signals | {"steer_angle": torch.atan2(along_y, along_x)}))
    found = twist_from_wheels(wheels, motion.mechanism.constants())
    torch.testing.assert_close(found, signals["chassis_velocity"])


@pytest.mark.parametrize("kind", list(MACHINES))
def test_a_state_holds_the_signals_that_it_was_made_of(kind):
    motion, signals = motion_of(MACHINES[kind]), some_signals(kind, (2, 3), seed=1)
    state = motion.pack(signals)
    back = motion.signals(state)
    for name in motion.parts:
        torch.testing.assert_close(back[name], signals[name])
    torch.testing.assert_close(motion.normalise(state), state)


@pytest.mark.parametrize("kind", list(MACHINES))
def test_the_rate_of_momentum_is_what_acts_with_all_effects_and_turning_frames(kind):
    """Along any motion, and by the very balance that the diagnosis tests."""
    effects = tuple(
        FittedEffect(effect, effect.defaults()) for effect in effects_of(kind) if not remembers(effect)
    )
    simulator, motion, tiny = Simulator(MACHINES[kind], effects), motion_of(MACHINES[kind]), 1e-5
    signals = some_signals(kind, (8,), seed=3)
    names = {
        "quadrotor": ["rotor_speed", "battery_voltage"],
        "swerve": ["drive_voltage", "steer_voltage", "battery_voltage"],
        "joint": ["voltage", "battery_voltage", "temperature"],
    }[kind]
    commands = {name: signals[name][:, None].repeat_interleave(2, dim=1) for name in names}
    states = rollout(simulator, motion.pack(signals), commands, tiny)
    along = simulator.along_time(
        motion.signals(states, simulator.constants())
        | {n: signals[n][:, None].expand(-1, 3, *signals[n].shape[1:]) for n in names},
        tiny,
    )
    balance = simulator.balance(along)
    for name, momentum in balance.momentum.items():
        found = (momentum[:, 2] - momentum[:, 0]) / (2.0 * tiny)
        size = float(balance.rate[name].abs().max())
        torch.testing.assert_close(found, balance.rate[name][:, 1], rtol=1e-4, atol=1e-5 * size, msg=name)


def test_rotation_alone_is_that_of_the_whole_flight():
    """Without drag a body turns the same wherever it is, so that its rates can be predicted from rates alone."""
    simulator, signals = Simulator(MACHINES["quadrotor"]), some_signals("quadrotor", (4,), seed=2)
    commands = {"rotor_speed": signals["rotor_speed"][:, None].repeat_interleave(20, dim=1)}
    whole = rollout(simulator, motion_of(simulator.platform).pack(signals), commands, 0.005)
    rates = {"body_rate": signals["body_rate"]}
    alone = motion_of(simulator.platform, rates)
    assert alone.parts.keys() == {"body_rate"}
    states = rollout(simulator, alone.pack(rates), commands, 0.005)
    torch.testing.assert_close(states, whole[..., 10:13])


def remembers(effect) -> bool:
    """Whether what acts depends on more than the instant."""
    return isinstance(effect, MeasurementEffect) or getattr(effect, "remembers", False)
