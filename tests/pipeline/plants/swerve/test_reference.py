import numpy as np
import pytest

from simgap.plants.swerve.case import MANOEUVRES, SwerveCase, SwerveSensors
from simgap.plants.swerve.motion import STEP, Log
from simgap.plants.swerve.reference import names, references
from simgap.plants.swerve.sensing import record

TIMES = np.arange(-800, 4001) * STEP


@pytest.mark.parametrize("name", MANOEUVRES)
def test_references_stay_within_their_limits_and_modules_agree(robot, name):
    """Module speeds come from one twist, so that wheels that follow never fight each other."""
    case = SwerveCase(manoeuvres=[name], runs=3, duration=4.0)
    reference = references(case, robot, TIMES, np.random.default_rng(2))
    assert np.abs(reference.speed).max() <= case.speed * (1 + 1e-9)
    assert np.abs(reference.pace).max() <= case.acceleration * (1 + 1e-9)
    places = np.array(robot.module_positions)
    rows = np.concatenate([[[1.0, 0.0, -y], [0.0, 1.0, x]] for x, y in places])
    velocity = (
        np.stack((np.cos(reference.angle), np.sin(reference.angle)), axis=-1) * reference.speed[..., None]
    )
    velocity = velocity.reshape(*velocity.shape[:2], 8)
    twist = velocity @ np.linalg.pinv(rows).T
    np.testing.assert_allclose(twist @ rows.T, velocity, atol=1e-9)
    assert np.abs(twist[..., 2]).max() <= case.yaw_rate * (1 + 1e-9)


def test_modules_turn_on_without_jumps(robot):
    case = SwerveCase(runs=8, duration=4.0)
    reference = references(case, robot, TIMES, np.random.default_rng(3))
    assert np.abs(np.diff(reference.angle, axis=0)).max() < 3.0 * case.steering_rate * STEP
    assert [name.split("_")[0] for name in names(case)] == case.manoeuvres * 2


def test_an_arena_is_driven_in_all_directions_with_the_robot_turning_both_ways(robot):
    case = SwerveCase(manoeuvres=["arena"], runs=4, duration=40.0)
    times = np.arange(-800, 40_001) * STEP
    reference = references(case, robot, times, np.random.default_rng(4))
    places = np.array(robot.module_positions)
    along = np.stack((np.cos(reference.angle), np.sin(reference.angle)), axis=-1) * reference.speed[..., None]
    velocity = along.mean(axis=2)
    moving = np.hypot(velocity[..., 0], velocity[..., 1]) > 0.3 * case.speed
    eighths = (np.arctan2(velocity[..., 1], velocity[..., 0])[moving] // (np.pi / 4)).astype(int)
    assert set(eighths) == set(range(-4, 4))
    yaw = (places[:, 0] * along[..., 1] - places[:, 1] * along[..., 0]).sum(axis=2) / (places**2).sum()
    assert yaw.min() < -0.5 * case.yaw_rate
    assert yaw.max() > 0.5 * case.yaw_rate
    assert np.abs(yaw[moving]).min() > 0.1


def test_modules_turn_by_a_quarter_at_most_at_the_stops_of_an_arena(robot):
    case = SwerveCase(manoeuvres=["arena"], runs=4, duration=40.0)
    times = np.arange(-800, 40_001) * STEP
    reference = references(case, robot, times, np.random.default_rng(4))
    assert np.abs(np.diff(reference.angle, axis=0)).max() < 3.0 * case.steering_rate * STEP
    meanwhile = 0.3  # rad by which the course goes on during a stop
    for run in range(case.runs):
        standing = np.flatnonzero((reference.speed[:, run] == 0.0).all(axis=1))
        stops = np.split(standing, np.flatnonzero(np.diff(standing) > 1) + 1)
        assert len(stops) > 5
        turned = [np.ptp(reference.angle[stop, run], axis=0).max() for stop in stops]
        assert max(turned) < 0.5 * np.pi + meanwhile


def test_the_motion_is_recorded_late_and_with_the_stated_noise():
    case = SwerveCase(runs=1, duration=4.0, rate=500.0, dropped=0.1, channels=["chassis"])
    wave = np.sin(3.0 * TIMES)
    modules, twist = np.tile(wave[:, None, None], (1, 1, 4)), np.tile(wave[:, None, None], (1, 1, 3))
    log = Log(*[modules] * 7, twist, wave[:, None])
    frame = record(log, case, 0.02, ("weave_1",), [0])
    late, now = np.sin(3.0 * (frame["t"] - 0.02)), np.sin(3.0 * frame["t"])
    sensors = SwerveSensors()
    assert 0.85 * 2000 < len(frame) < 0.95 * 2000
    np.testing.assert_allclose(frame["drive_voltage_2"], now, atol=0.6 * sensors.voltage_step)
    for channel, spread in (
        ("drive_velocity_1", sensors.drive_velocity),
        ("steer_velocity_4", sensors.steer_velocity),
        ("chassis_velocity_y", sensors.chassis_velocity),
        ("chassis_rate", sensors.chassis_rate),
    ):
        assert (frame[channel] - late).std() == pytest.approx(spread, rel=0.1)
    steps = frame["steer_angle_3"] / sensors.steer_angle_step
    np.testing.assert_allclose(steps, steps.round(), atol=1e-6)
    assert "battery_voltage" not in frame
