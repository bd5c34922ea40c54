import numpy as np
import pytest

from simgap.plants.case import PlantCase, Sensors
from simgap.plants.flight import SETTLING, Log
from simgap.plants.sensing import record

STEPS = round((SETTLING + 4.0) / 1e-3) + 1


@pytest.fixture
def log():
    """A made-up truth whose every channel is a known function of time."""
    time = np.arange(STEPS) * 1e-3 - SETTLING
    wave = np.sin(3.0 * time)[:, None, None]
    level = np.zeros((STEPS, 2, 4))
    level[..., 0] = 1.0
    vector = np.broadcast_to(wave, (STEPS, 2, 3))
    speed = np.broadcast_to(1000.0 + 100.0 * wave, (STEPS, 2, 4))
    return Log(vector, vector, level, vector, vector, speed, speed)


def recorded(log, racer, **kwargs):
    case = PlantCase(runs=2, duration=4.0, **kwargs)
    return record(log, racer, case, ("a_1", "b_2"), np.ones(2), np.random.default_rng(0))


def test_perfect_sensors_record_the_truth(log, racer):
    frame = recorded(log, racer, sensors=Sensors(scale=0.0))
    wave = np.sin(3.0 * frame["t"])
    np.testing.assert_allclose(frame["velocity_x"], wave, atol=1e-6)
    np.testing.assert_allclose(frame["motor_speed_3"], 1000 + 100 * wave, atol=1e-4)
    np.testing.assert_allclose(
        frame["motor_command_3"], (1000 + 100 * wave) / racer.motor_speed_max, atol=1e-6
    )
    assert list(frame["run"].unique()) == ["a_1", "b_2"]
    assert len(frame) == 800


def test_a_time_offset_makes_the_state_late_and_leaves_the_motors(log, racer):
    frame = recorded(log, racer, sensors=Sensors(scale=0.0), effects={"sensor_time_offset": 0.0245})
    np.testing.assert_allclose(frame["velocity_x"], np.sin(3.0 * (frame["t"] - 0.0245)), atol=1e-5)
    np.testing.assert_allclose(frame["motor_speed_1"], 1000 + 100 * np.sin(3.0 * frame["t"]), atol=1e-4)


def test_noise_has_the_stated_size_and_steps(log, racer):
    sensors = Sensors()
    frame = recorded(log, racer, sensors=sensors)
    wave = np.sin(3.0 * frame["t"])
    for channel, spread in (
        ("position_y", sensors.position),
        ("velocity_z", sensors.velocity),
        ("body_rate_x", sensors.body_rate),
        ("specific_force_z", sensors.specific_force),
    ):
        assert (frame[channel] - wave).std() == pytest.approx(spread, rel=0.1)
    assert 2 * frame["attitude_x"].std() == pytest.approx(sensors.attitude, rel=0.1)
    for channel, step in (("motor_speed_1", 1.5), ("body_rate_y", sensors.body_rate_step)):
        steps = frame[channel] / step
        np.testing.assert_allclose(steps, steps.round(), atol=1e-6)


def test_attitudes_stay_unit_quaternions(log, racer):
    frame = recorded(log, racer)
    norm = np.linalg.norm(frame[[f"attitude_{axis}" for axis in "wxyz"]], axis=1)
    np.testing.assert_allclose(norm, 1.0, rtol=1e-12)


def test_samples_are_lost_and_instants_jitter(log, racer):
    frame = recorded(log, racer, sensors=Sensors(scale=0.0), dropped=0.1, jitter=1e-3)
    assert 0.85 * 800 < len(frame) < 0.95 * 800
    np.testing.assert_allclose(frame["velocity_x"], np.sin(3.0 * frame["t"]), atol=1e-5)
    for _, run in frame.groupby("run"):
        assert (run["t"].diff().dropna() > 0).all()
        assert run["t"].iloc[0] == 0.0


def test_the_battery_sags_and_empties(racer):
    time = np.arange(STEPS) * 1e-3 - SETTLING
    speed = np.broadcast_to(np.where(time < 2.0, 1000.0, 1500.0)[:, None, None], (STEPS, 2, 4))
    zero, level = np.zeros((STEPS, 2, 3)), np.broadcast_to([1.0, 0.0, 0.0, 0.0], (STEPS, 2, 4))
    frame = recorded(Log(zero, zero, level, zero, zero, speed, speed), racer, sensors=Sensors(scale=0.0))
    voltage = frame["battery_voltage"].to_numpy()[:400]
    assert 0.9 * racer.nominal_voltage < voltage[-1] < 1.15 * racer.nominal_voltage
    assert voltage[150] < voltage[0]
    assert voltage[199] - voltage[201] > 0.2


def test_a_concealed_driver_is_not_recorded(log, racer):
    frame = recorded(log, racer, hidden=["motor_speed", "battery_voltage"])
    assert not [column for column in frame if column.startswith(("motor_speed", "battery"))]
    assert "motor_command_1" in frame
    whole = recorded(log, racer)
    assert frame.equals(whole[frame.columns])  # all else is as it was


def test_an_estimator_believes_something_near_the_truth(log, racer):
    frame, truth = recorded(log, racer, estimates=1.0), recorded(log, racer, sensors=Sensors(scale=0.0))
    error = frame["estimate_velocity_x"] - truth["velocity_x"]
    assert 0.01 < error.std() < 0.3
    norm = np.linalg.norm(frame[[f"estimate_attitude_{axis}" for axis in "wxyz"]], axis=1)
    np.testing.assert_allclose(norm, 1.0)
    sensed = recorded(log, racer)
    assert frame[sensed.columns].equals(sensed)
