"""A swerve drive whose wheels roll without sliding sideways goes where they point, and nowhere else."""

import math

import pytest
import torch
from hypothesis import example, given, settings
from hypothesis import strategies as st

from simgap.platforms.swerve_constraint import along_the_wheels, rolling_projection
from simgap.platforms.swerve_kinematics import lateral_matrix, module_states, rolling_speed
from simgap.simulation import Simulator, rollout
from simgap.simulation.integration import rk4
from simgap.simulation.motion import SwerveMotion
from tests.pipeline.platforms.machines import SWERVE, some_signals

POSITIONS = torch.tensor(SWERVE.module_positions, dtype=torch.float64)
MOTION = SwerveMotion(SWERVE)
CONSTANTS = Simulator(SWERVE).constants()
LEAK = 1e-3
"""Part of what acts across the wheels that the smooth projection lets through."""


def state(twist: list[float], angle: torch.Tensor, turning: float = 0.0) -> torch.Tensor:
    return torch.cat(
        [torch.tensor(twist).double(), angle, torch.full((4,), turning).double(), torch.zeros(1).double()]
    )


def coasting(start: torch.Tensor, time_step: float, steps: int) -> torch.Tensor:
    """Return the states of a chassis on which nothing but its wheels' side forces acts."""
    nothing = {name: torch.zeros(()).double() for name in Simulator(SWERVE).nominal_inertia()}
    states = [start]
    for _ in range(steps):
        states.append(rk4(MOTION, lambda _: nothing, states[-1], CONSTANTS, time_step))
    return torch.stack(states)


def energy(states: torch.Tensor) -> torch.Tensor:
    masses = torch.tensor([SWERVE.mass, SWERVE.mass, SWERVE.inertia]).double()
    return 0.5 * (masses * states[..., :3].square()).sum(-1)


@given(angle=st.floats(-7.0, 7.0), seed=st.integers(0, 10**6))
@settings(max_examples=10)
def test_modules_at_one_angle_accelerate_the_robot_along_it_only(angle, seed):
    """Whatever the wheels pull: four different torques would turn a free body."""
    volts = some_signals("swerve", (1, 1), seed)["drive_voltage"].expand(1, 20, 4)
    commands = {"drive_voltage": volts, "steer_voltage": torch.zeros_like(volts)}
    start = state([0.0, 0.0, 0.0], torch.full((4,), angle).double())
    last = rollout(Simulator(SWERVE), start[None], commands, 0.01)[0, -1]
    along = last[0] * math.cos(angle) + last[1] * math.sin(angle)
    across = last[1] * math.cos(angle) - last[0] * math.sin(angle)
    mean, largest = float(volts[0, 0].mean()), float(volts.abs().max())
    assert float(along) * mean > 0.0
    assert abs(float(across)) < LEAK * 0.1 * largest
    assert abs(float(last[2])) < LEAK * largest


@pytest.mark.parametrize("turning", [0.5, 2.0])
def test_speed_stays_along_the_wheels_while_all_modules_turn_together(turning):
    """The robot does not turn its heading: only the side forces turn its velocity, and they do no work."""
    states = coasting(state([2.0, 0.0, 0.0], torch.zeros(4).double(), turning), 0.01, 200)
    angle = states[:, 3]
    expected = 2.0 * torch.stack([torch.cos(angle), torch.sin(angle)], dim=-1)
    assert float(angle[-1]) == pytest.approx(2.0 * turning)
    torch.testing.assert_close(states[:, :2], expected, rtol=0.0, atol=2.0 * 6.0 * LEAK)
    torch.testing.assert_close(energy(states), energy(states[:1]).expand(201), rtol=6.0 * LEAK, atol=0.0)
    torch.testing.assert_close(states[:, 2], torch.zeros_like(angle), rtol=0.0, atol=1e-9)


@given(seed=st.integers(0, 10**6))
@example(seed=126)
@settings(max_examples=10)
def test_a_coasting_robot_follows_the_circle_of_its_wheels(seed):
    twist = some_signals("swerve", (), seed)["chassis_velocity"]
    angle, _ = module_states(twist, POSITIONS, torch.zeros(4).double())
    states = coasting(state(twist.tolist(), angle), 0.02, 50)
    turning = float(twist[:2].norm() * twist[2].abs())  # m/s² that the wheels have to hold, for one second
    leaked = 3.0 * LEAK * turning
    torch.testing.assert_close(states[:, :3], twist.expand(51, 3), rtol=0.0, atol=leaked)
    time = torch.arange(51, dtype=torch.float64) * 0.02
    torch.testing.assert_close(states[:, 11], twist[2] * time, rtol=0.0, atol=leaked)


def test_wheels_that_stand_in_a_cross_lock_the_robot():
    angle = torch.tensor([math.atan2(y, x) for x, y in SWERVE.module_positions]).double()
    volts = torch.tensor([6.0, -3.0, 2.0, 8.0]).double().expand(1, 20, 4)
    commands = {"drive_voltage": volts, "steer_voltage": torch.zeros_like(volts)}
    states = rollout(Simulator(SWERVE), state([0.0, 0.0, 0.0], angle)[None], commands, 0.01)
    assert float(states[..., :3].abs().max()) < 0.8 * LEAK * 8.0


@given(seed=st.integers(0, 10**6))
def test_a_projection_keeps_what_wheels_allow_and_takes_the_rest(seed):
    """In coordinates in which momentum and velocity are one, and to the little that it lets through."""
    twist = some_signals("swerve", (), seed)["chassis_velocity"]
    angle, _ = module_states(twist, POSITIONS, torch.zeros(4).double())
    projection, _ = rolling_projection(angle, torch.zeros_like(angle), CONSTANTS)
    masses = torch.tensor([SWERVE.mass, SWERVE.mass, SWERVE.inertia]).double()
    torch.testing.assert_close(projection @ (masses * twist), masses * twist, rtol=1e-9, atol=1e-9)
    lengths = (masses / SWERVE.mass).sqrt()
    for row in lateral_matrix(angle, POSITIONS):
        assert float((projection @ row / lengths).norm() / (row / lengths).norm()) < LEAK


@pytest.mark.parametrize(("toe", "lost"), [(0.05, 1e-3), (0.1, 2e-3)])
def test_wheels_that_toe_in_drag_and_do_not_lock(toe, lost):
    angle = toe * torch.tensor([1.0, -1.0, 1.0, -1.0]).double()
    projection, _ = rolling_projection(angle, torch.zeros_like(angle), CONSTANTS)
    assert 1.0 - lost < float(projection[0, 0]) <= 1.0


@given(seed=st.integers(0, 10**6))
def test_side_slip_hinders_no_other_motion_less(seed):
    """Of all motions with the energy of the one found, with tyres whose side force grows with the slip angle."""
    random = torch.Generator().manual_seed(seed)
    twist = some_signals("swerve", (), seed)["chassis_velocity"]
    angle = module_states(twist, POSITIONS, torch.zeros(4).double())[0]
    angle = angle + 0.03 * torch.randn(4, generator=random, dtype=torch.float64)
    masses = torch.tensor([SWERVE.mass, SWERVE.mass, SWERVE.inertia]).double()
    speed = torch.hypot(rolling_speed(twist, angle, POSITIONS), torch.tensor(CONSTANTS["creep"]).double())

    def resistance(motion):
        lost = ((lateral_matrix(angle, POSITIONS) @ motion).square() / speed).sum()
        return float(lost / (masses * motion @ motion))

    found = along_the_wheels(twist, angle, CONSTANTS)
    others = found + 0.02 * torch.randn(50, 3, generator=random, dtype=torch.float64)
    assert all(resistance(found) < 1.001 * resistance(other) + 1e-9 for other in others)


@given(seed=st.integers(0, 10**6))
def test_the_rate_of_a_projection_is_its_slope_in_time(seed):
    signals, tiny = some_signals("swerve", (), seed), 1e-6
    angle, turning = signals["steer_angle"], signals["steer_velocity"]
    _, rate = rolling_projection(angle, turning, CONSTANTS)
    later, sooner = (
        rolling_projection(angle + sign * tiny * turning, turning, CONSTANTS)[0] for sign in (1, -1)
    )
    slope = (later - sooner) / (2.0 * tiny)
    torch.testing.assert_close(rate, slope, rtol=1e-4, atol=1e-4 * float(rate.abs().max()))
