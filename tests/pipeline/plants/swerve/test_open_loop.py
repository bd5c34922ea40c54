from pathlib import Path

import numpy as np
import pytest
import yaml

from simgap.errors import InputError
from simgap.plants.swerve.case import SwerveCase, SwerveSensors
from simgap.plants.swerve.open_loop import drive_trials
from simgap.platforms import Swerve, platform_from_config

PERIOD = 0.01
PERFECT = SwerveSensors(scale=0.0)


@pytest.fixture(scope="module")
def shuttle() -> Swerve:
    path = Path(__file__).parents[4] / "conf/platform/swerve_shuttle.yaml"
    return platform_from_config(yaml.safe_load(path.read_text()))


def pulse(voltage, steps=60):
    return np.full((steps, 4), voltage)


def drive(platform, voltage, trials=1, scatter=0.0, seed=0, **effects):
    case = SwerveCase(effects=effects, sensors=PERFECT)
    return drive_trials(case, platform, voltage, PERIOD, trials, scatter, seed)


def test_the_null_robot_obeys_the_linear_motor_law(shuttle):
    """V = kV·v + kA·dv/dt with the platform's own constants, held still before and free to roll after."""
    (trial,) = drive(shuttle, pulse(6.0))
    motor, ratio = shuttle.drive.motor, shuttle.drive.gear_ratio / shuttle.wheel_radius
    per_speed = motor.back_emf_constant * ratio
    per_acceleration = 0.25 * shuttle.mass * motor.resistance / (motor.torque_constant * ratio)
    time = trial.time[trial.time <= 0.6]
    exact = 6.0 / per_speed * -np.expm1(-time * per_speed / per_acceleration)
    np.testing.assert_allclose(trial.velocity[: len(time)], exact, atol=0.02)
    assert trial.position[-1] > trial.position[len(time)] > 0.0


def test_it_goes_straight_ahead(shuttle):
    (trial,) = drive(shuttle, pulse(6.0))
    assert np.abs(trial.aside).max() < 1e-3


def test_forth_and_back_mirror_each_other(shuttle):
    forth, back = (drive(shuttle, pulse(sign * 6.0))[0] for sign in (1.0, -1.0))
    np.testing.assert_allclose(forth.position, -back.position, atol=1e-6)


def test_friction_stops_it(shuttle):
    (trial,) = drive(shuttle, pulse(3.0, 30), **{"coulomb_friction@drive": {"level": 0.1}})
    assert trial.velocity[-1] == pytest.approx(0.0, abs=1e-3)


def test_no_voltage_beyond_what_the_battery_has_is_applied(shuttle):
    """A controller cannot give more than the nominal voltage."""
    most, beyond = (drive(shuttle, pulse(voltage))[0] for voltage in (12.0, 30.0))
    np.testing.assert_array_equal(most.position, beyond.position)


@pytest.mark.slow
def test_trials_differ_by_what_is_concealed_and_a_seed_fixes_them(shuttle):
    rubbing = {"coulomb_friction@drive": {"level": 0.05}}
    first = drive(shuttle, pulse(6.0), trials=3, scatter=0.1, seed=1, **rubbing)
    again = drive(shuttle, pulse(6.0), trials=3, scatter=0.1, seed=1, **rubbing)
    ends = [trial.position[-1] for trial in first]
    assert ends == [trial.position[-1] for trial in again]
    assert len(set(ends)) == 3
    alike = drive(shuttle, pulse(6.0), trials=2, scatter=0.0, seed=1, **rubbing)
    assert alike[0].position[-1] == alike[1].position[-1]


@pytest.mark.parametrize("period", [0.0005, 0.0125, 0.003])
def test_a_period_that_does_not_fit_is_refused(shuttle, period):
    with pytest.raises(InputError, match="period"):
        drive_trials(SwerveCase(), shuttle, pulse(1.0), period, 1, 0.0, 0)
