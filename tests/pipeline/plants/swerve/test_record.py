import hashlib

import numpy as np
import pandas as pd
import pytest

from simgap.effects.catalogue import effects_of
from simgap.errors import InputError
from simgap.plants import case_from_config, record_case
from simgap.plants.joint.case import JointCase
from simgap.plants.sealing import key_text
from simgap.plants.swerve.case import SwerveCase, SwerveSensors
from simgap.plants.swerve.effects import CONCEALABLE, OUTSIDE
from tests.pipeline.plants.reading import assert_read_as_written

SHORT = {"runs": 4, "duration": 1.0}
PERFECT = SwerveSensors(scale=0.0)


def four(run, name):
    return run[[f"{name}_{module}" for module in range(1, 5)]].to_numpy()


def summed(values, rate):
    return (
        np.concatenate(([np.zeros_like(values[0])], np.cumsum(0.5 * (values[1:] + values[:-1]), axis=0)))
        / rate
    )


def torque(run, axis, group, motor_speed):
    motor = axis.motor
    current = (four(run, f"{group}_voltage") - motor.back_emf_constant * motor_speed) / motor.resistance
    return axis.gear_ratio * motor.torque_constant * current


@pytest.fixture(scope="module")
def null_run(machine):
    case = SwerveCase(
        runs=4, duration=3.0, rate=1000.0, speed=2.0, acceleration=3.0, dropped=0.0, sensors=PERFECT
    )
    recording, key = record_case(case, machine, seed=5)
    assert key["effects"] == key["outside"] == []
    return recording.frame


def test_the_null_case_turns_all_power_of_the_motors_into_motion(machine, null_run):
    """Side forces do no work, so that the nominal robot's kinetic energy is the work of its drive motors."""
    for _, run in null_run.groupby("run"):
        x, y, yaw = (
            run[name].to_numpy() for name in ("chassis_velocity_x", "chassis_velocity_y", "chassis_rate")
        )
        energy = 0.5 * machine.mass * (x**2 + y**2) + 0.5 * machine.inertia * yaw**2
        motors = four(run, "drive_velocity")
        power = (torque(run, machine.drive, "drive", motors) * motors / machine.drive.gear_ratio).sum(axis=1)
        work = summed(power, 1000.0)
        np.testing.assert_allclose(work, energy - energy[0], atol=0.01 * energy.max())


def test_the_null_case_rolls_where_its_wheels_point(machine, null_run):
    angle = four(null_run, "steer_angle")
    wheels = four(null_run, "drive_velocity") * machine.wheel_radius / machine.drive.gear_ratio
    x, y, yaw = (
        null_run[[name]].to_numpy() for name in ("chassis_velocity_x", "chassis_velocity_y", "chassis_rate")
    )
    places = np.array(machine.module_positions)
    along = (x - yaw * places[:, 1]) * np.cos(angle) + (y + yaw * places[:, 0]) * np.sin(angle)
    across = (y + yaw * places[:, 0]) * np.cos(angle) - (x - yaw * places[:, 1]) * np.sin(angle)
    noise = SwerveSensors().chassis_velocity
    assert np.abs(along - wheels).max() < 0.2 * noise
    assert np.sqrt((across**2).mean()) < noise


def test_the_null_case_turns_its_modules_by_the_nominal_equations(machine, null_run):
    for _, run in null_run.groupby("run"):
        turning = four(run, "steer_velocity")
        moment = torque(run, machine.steer, "steer", machine.steer.gear_ratio * turning)
        momentum = machine.steer.inertia * (turning - turning[0])
        np.testing.assert_allclose(summed(moment, 1000.0), momentum, atol=2e-3 * np.abs(momentum).max())


def test_held_voltages_change_at_samples_and_are_logged_as_they_are_held(robot):
    options = {"runs": 2, "duration": 2.0, "dropped": 0.0, "sensors": PERFECT, "bandwidth": 20.0}
    sampled = record_case(SwerveCase(rate=50.0, held=True, **options), robot, seed=5)[0].frame
    motor, names = robot.steer.motor, [f"steer_{part}_1" for part in ("voltage", "velocity")]
    lag = (
        robot.steer.inertia
        * motor.resistance
        / (robot.steer.gear_ratio**2 * motor.torque_constant * motor.back_emf_constant)
    )
    decay = np.exp(-0.02 / lag)
    for _, run in sampled.groupby("run"):
        voltage, rate = (run[name].to_numpy() for name in names)
        settled = voltage / (robot.steer.gear_ratio * motor.back_emf_constant)
        predicted = decay * rate[:-1] + (1.0 - decay) * settled[:-1]
        np.testing.assert_allclose(rate[1:], predicted, atol=0.01 * np.abs(rate).max())


def test_the_same_seed_gives_the_same_recording_and_another_another(robot):
    case = SwerveCase(effects={"coulomb_friction@drive": {}}, **SHORT)
    first, again, other = (record_case(case, robot, seed)[0].frame for seed in (3, 3, 4))
    pd.testing.assert_frame_equal(first, again)
    assert not first["steer_angle_1"].equals(other["steer_angle_1"])


def test_twins_have_the_same_instants_and_noise(robot):
    null = record_case(SwerveCase(**SHORT, jitter=1e-4), robot, seed=3)[0].frame
    twin = record_case(SwerveCase(effects={"backlash@steer": {}}, **SHORT, jitter=1e-4), robot, seed=3)[
        0
    ].frame
    assert null["t"].equals(twin["t"])
    assert 0 < (null["steer_angle_1"] - twin["steer_angle_1"]).abs().max() < 0.2
    channels = ["chassis", "battery_voltage", "current"]
    more = record_case(SwerveCase(**SHORT, jitter=1e-4, channels=channels), robot, seed=3)[0].frame
    pd.testing.assert_frame_equal(more[null.columns], null)
    assert {"battery_voltage", "drive_current_1", "steer_current_4"} <= set(more.columns)


def test_the_record_carries_the_hash_of_the_key_and_nothing_of_its_content(robot):
    recording, key = record_case(SwerveCase(effects={"slope@chassis": {}}, **SHORT), robot, seed=3)
    assert hashlib.sha256(key_text(key).encode()).hexdigest() in recording.source
    assert "slope" not in recording.source


@pytest.fixture(scope="module")
def null(robot):
    return record_case(SwerveCase(**SHORT, sensors=PERFECT), robot, seed=1)[0].frame


@pytest.mark.slow
@pytest.mark.parametrize("name", CONCEALABLE)
def test_every_effect_acts_and_the_key_speaks_the_language_of_the_catalogue(robot, null, name):
    recording, key = record_case(SwerveCase(effects={name: {}}, **SHORT, sensors=PERFECT), robot, seed=1)
    moved = recording.frame
    assert (
        max(
            np.abs(four(moved, channel) - four(null, channel)).max()
            for channel in ("drive_velocity", "steer_velocity")
        )
        > 0.01
    )
    (entry,) = key["effects"]
    effect = next(effect for effect in effects_of("swerve") if effect.key == name)
    assert (entry["name"], entry["acts_on"]) == (effect.name, effect.acts_on)
    assert set(entry["parameters"]) == {parameter.name for parameter in effect.parameters}
    for parameter in effect.parameters:
        stated = entry["parameters"][parameter.name]
        assert stated["unit"] == effect.units()[parameter.name]
        assert parameter.low <= stated["value"] <= parameter.high


@pytest.mark.slow
@pytest.mark.parametrize("name", OUTSIDE)
def test_what_is_outside_acts_and_has_no_name_in_the_catalogue(robot, null, name):
    assert name not in {effect.name for effect in effects_of("swerve")}
    recording, key = record_case(SwerveCase(outside={name: {}}, **SHORT, sensors=PERFECT), robot, seed=1)
    moved = recording.frame
    assert key["effects"] == []
    assert [entry["name"] for entry in key["outside"]] == [name]
    assert (
        max(
            np.abs(four(moved, channel) - four(null, channel)).max()
            for channel in ("drive_velocity", "steer_velocity")
        )
        > 0.01
    )


def test_the_recording_keeps_the_contract_without_a_doubt(machine, tmp_path):
    case = SwerveCase(
        runs=3, duration=4.0, speed=2.0, acceleration=3.0, channels=["chassis", "battery_voltage"]
    )
    recording, _ = record_case(case, machine, seed=2)
    assert recording.kind == "swerve"
    assert_read_as_written(recording, tmp_path)


@pytest.mark.parametrize(
    ("case", "message"),
    [
        (SwerveCase(effects={"slope": {}}), "did you mean 'slope@chassis'"),
        (SwerveCase(effects={"slope@chassis": {"rise": 1.0}}), "record.effects.slope@chassis"),
        (SwerveCase(outside={"uneven_wheel": {"ratio": 9.0}}), "record.outside.uneven_wheel.ratio"),
        (SwerveCase(manoeuvres=["jump"]), "record.manoeuvres"),
        (SwerveCase(channels=["smell"]), "record.channels"),
        (SwerveCase(speed=0.0), "record.speed"),
        (SwerveCase(gentlest=2.0), "record.gentlest"),
        (SwerveCase(jitter=1.0), "record.jitter"),
        (SwerveCase(sensors=SwerveSensors(current=-1.0)), "record.sensors.current"),
    ],
)
def test_a_case_that_cannot_be_driven_is_refused_by_its_key(robot, case, message):
    with pytest.raises(InputError, match=message):
        record_case(case, robot, seed=0)


def test_a_case_of_another_machine_is_refused(robot):
    with pytest.raises(InputError, match="another machine than a swerve"):
        record_case(JointCase(), robot, seed=0)


def test_cases_are_built_from_mappings():
    values = {"runs": 3, "speed": 2, "sensors": {"scale": 0}, "effects": {"slope@chassis": {"rise_x": 0.1}}}
    case = case_from_config("swerve", values)
    assert (case.runs, case.speed, case.sensors.scale) == (3, 2.0, 0.0)
    assert case.effects == {"slope@chassis": {"rise_x": 0.1}}


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"sped": 2.0}, "did you mean 'speed'"),
        ({"sensors": {"curent": 2.0}}, "record.sensors: unknown key 'curent'"),
        ({"speed": "fast"}, "record.speed"),
        ({"runs": 1.5}, "record.runs"),
        ({"runs": True}, "record.runs"),
        ({"channels": "chassis"}, "record.channels"),
        ({"sensors": 1.0}, "record.sensors"),
    ],
)
def test_mappings_that_are_no_case_are_refused(values, message):
    with pytest.raises(InputError, match=message):
        case_from_config("swerve", values)
