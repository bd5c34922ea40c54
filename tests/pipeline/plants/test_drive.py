import numpy as np
import pytest

from simgap.plants.battery import Battery
from simgap.plants.case import PlantCase
from simgap.plants.drive import Drive, sag_exponent, speed_at_voltage

STEP = 1e-3


def drive(racer, charge=0.5, **effects):
    battery = Battery(racer, np.full(2, charge))
    return Drive(racer, PlantCase(effects=effects), np.random.default_rng(0), STEP, battery)


def ramp(index):
    return np.full((2, 4), 1000.0 + index)


def test_with_everything_off_it_turns_as_commanded(racer):
    motors = drive(racer)
    for index in range(5):
        speed, acceleration = motors(ramp(index))
        np.testing.assert_array_equal(speed, ramp(index))
    np.testing.assert_allclose(acceleration, 1.0 / STEP)


@pytest.mark.parametrize("delay", [0.0105, 0.02, 0.0003])
def test_commands_are_as_late_as_the_delay_says(racer, delay):
    motors = drive(racer, command_delay=delay)
    for index in range(100):
        speed, _ = motors(ramp(index))
    np.testing.assert_allclose(speed, 1000.0 + 99 - delay / STEP)


def test_a_lag_follows_a_step_exponentially(racer):
    motors = drive(racer, motor_lag=0.04)
    start = motors(np.full((2, 4), racer.hover_rotor_speed))[0]
    np.testing.assert_allclose(start, racer.hover_rotor_speed)
    for _ in range(40):
        speed, _ = motors(np.full((2, 4), racer.hover_rotor_speed + 100.0))
    gone = (speed - racer.hover_rotor_speed) / 100.0
    np.testing.assert_allclose(gone, 1.0 - np.exp(-0.04 / -(STEP / np.log(motors.decay))) * np.ones((2, 4)))
    assert gone.mean() == pytest.approx(1.0 - np.exp(-1.0), abs=0.06)


def test_at_nominal_voltage_a_motor_turns_as_commanded():
    command = np.array([[300.0, 1000.0, 1500.0, 2300.0]])
    np.testing.assert_allclose(speed_at_voltage(command, np.ones((1, 1)), 1168.0), command)


@pytest.mark.parametrize("sensitivity", [0.2, 0.8125, 1.0])
def test_hover_speed_falls_with_voltage_as_much_as_asked(sensitivity):
    def speed(relative):
        felt = np.full((1, 1), relative) ** sag_exponent(sensitivity)
        return speed_at_voltage(np.full((1, 4), 1168.0), felt, 1168.0)[0, 0]

    slope = (np.log(speed(1.001)) - np.log(speed(0.999))) / (np.log(1.001) - np.log(0.999))
    assert slope == pytest.approx(sensitivity, rel=1e-4)


def test_an_empty_battery_turns_the_rotors_slower_and_a_regulated_one_does_not(racer):
    command = np.full((2, 4), 1300.0)
    full, empty = (drive(racer, charge, battery_sag=0.8)(command)[0] for charge in (1.0, 0.15))
    assert (empty < full).all()
    np.testing.assert_array_equal(drive(racer, 0.15)(command)[0], command)


def test_the_lag_that_is_concealed_is_the_mean_of_the_rotors(racer):
    lags = -STEP / np.log(drive(racer, motor_lag=0.04).decay)
    assert np.ptp(lags) > 0.0
    assert lags.mean() == pytest.approx(0.04)


def test_the_scale_of_commands_is_the_mean_of_the_rotors(racer):
    speed, _ = drive(racer, command_scale_error=1.06)(np.full((2, 4), 1000.0))
    assert 0.0 < np.ptp(speed) < 20.0
    np.testing.assert_allclose(speed.mean(axis=1), 1060.0)


def test_rotors_slow_down_as_much_later_than_they_speed_up_as_asked(racer):
    """The times in which nine tenths of a step are done, far from where one time constant goes over into the other."""

    def time_of(step):
        motors = drive(racer, motor_lag={"time_constant": 0.04, "down_ratio": 2.25})
        motors(np.full((2, 4), racer.hover_rotor_speed))
        for index in range(1, 1000):
            speed, _ = motors(np.full((2, 4), racer.hover_rotor_speed + step))
            if ((speed - racer.hover_rotor_speed) / step).mean() > 0.63:
                return index * STEP

    up, down = time_of(600.0), time_of(-600.0)
    assert down / up == pytest.approx(2.25, rel=0.1)
    assert np.sqrt(up * down) == pytest.approx(0.04, rel=0.1)


def test_a_lag_without_a_ratio_is_the_same_up_and_down(racer):
    case = PlantCase(effects={"motor_lag": 0.04})
    assert case.strength("motor_lag", "down_ratio") == 1.0
