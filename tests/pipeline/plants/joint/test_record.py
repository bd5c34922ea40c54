import dataclasses
import hashlib

import numpy as np
import pandas as pd
import pytest

from simgap.effects.catalogue import effects_of
from simgap.errors import InputError
from simgap.plants import record_case
from simgap.plants.joint.case import JointCase, JointSensors
from simgap.plants.joint.effects import CONCEALABLE, NEEDS_CONTROLLER, NEEDS_MOTOR, OUTSIDE
from simgap.plants.sealing import key_text
from simgap.platforms import Controller
from tests.pipeline.plants.reading import assert_read_as_written

SHORT = {"runs": 4, "duration": 2.0}
PERFECT = JointSensors(scale=0.0)


def sliding_case(**kwargs):
    return JointCase(sliding=True, amplitude=0.2, velocity=0.8, acceleration=6.0, **kwargs)


def case_for(platform, **kwargs):
    """Return a case that suits one of the test machines."""
    slides = platform.motor is None and platform.gravity_torque == 0
    return sliding_case(**kwargs) if slides else JointCase(**kwargs)


@pytest.mark.parametrize("held", [False, True])
def test_the_null_case_is_the_nominal_machine(machine, held):
    """Momentum is the impulse of effort, weight, spring and back-EMF, to the trapezoidal rule's error."""
    rate = 200.0 if held else 1000.0
    case = case_for(machine, runs=4, duration=3.0, rate=rate, held=held, dropped=0.0, sensors=PERFECT)
    recording, key = record_case(case, machine, seed=5)
    assert key["effects"] == key["outside"] == []
    for _, run in recording.frame.groupby("run"):
        position, velocity = run["position"].to_numpy(), run["velocity"].to_numpy()
        effort, braking = nominal_effort(run, machine)
        load = machine.gravity_torque * np.sin(position) + machine.stiffness * position
        impulse = sum_up(effort, rate, held) - sum_up(load, rate) - braking * (position - position[0])
        momentum = machine.inertia * (velocity - velocity[0])
        np.testing.assert_allclose(impulse, momentum, atol=2e-3 * np.abs(momentum).max())


@pytest.mark.parametrize("held", [False, True])
def test_a_servo_follows_its_law_but_for_its_encoder_and_its_current(told, held):
    """The loop's effort gives the momentum to a fiftieth; a held command, which arrives 1 ms late, to a tenth."""
    case = {"runs": 4, "duration": 3.0, "rate": 200.0, "held": held, "dropped": 0.0, "sensors": PERFECT}
    case |= {"amplitude": 1.0, "velocity": 4.0, "acceleration": 30.0}
    recording, key = record_case(JointCase(**case), told, seed=5)
    assert key["effects"] == key["outside"] == []
    assert set(recording.units) == {"position", "velocity", "position_command"}
    gains = told.controller
    for _, run in recording.frame.groupby("run"):
        position, velocity = run["position"].to_numpy(), run["velocity"].to_numpy()
        pull = gains.proportional * position + told.gravity_torque * np.sin(position)
        told_to = gains.proportional * run["position_command"].to_numpy()
        impulse = sum_up(told_to, 200.0, held) - sum_up(pull + gains.derivative * velocity, 200.0)
        momentum = told.inertia * (velocity - velocity[0])
        np.testing.assert_allclose(impulse, momentum, atol=(0.1 if held else 0.02) * np.abs(momentum).max())


def test_a_velocity_that_nobody_records_changes_nothing_else(told):
    whole = record_case(JointCase(**SHORT), told, seed=1)[0].frame
    without = record_case(JointCase(**SHORT, without=["velocity"]), told, seed=1)[0].frame
    pd.testing.assert_frame_equal(without, whole.drop(columns="velocity"))


@pytest.mark.parametrize("effect", NEEDS_CONTROLLER)
def test_an_effect_of_the_loop_needs_a_controller(servo, effect):
    with pytest.raises(InputError, match="needs a controller"):
        record_case(JointCase(effects={effect: {}}, **SHORT), servo, seed=0)


def test_a_servo_that_is_told_a_position_has_no_effect_of_a_voltage_and_no_unknown_gain(told):
    with pytest.raises(InputError, match="needs a motor"):
        record_case(JointCase(effects={NEEDS_MOTOR[0]: {}}, **SHORT), told, seed=0)
    vague = dataclasses.replace(told, controller=Controller(derivative=0.6))
    with pytest.raises(InputError, match=r"platform.controller.proportional: is unknown"):
        record_case(JointCase(**SHORT), vague, seed=0)


def nominal_effort(run, machine):
    if machine.motor is None:
        return run["effort"].to_numpy(), 0.0
    constant = machine.motor.torque_constant * machine.motor.gear_ratio
    return constant / machine.motor.resistance * run[
        "voltage"
    ].to_numpy(), constant**2 / machine.motor.resistance


def sum_up(values, rate, held=False):
    steps = values[:-1] if held else 0.5 * (values[:-1] + values[1:])
    return np.concatenate(([0.0], np.cumsum(steps))) / rate


def test_the_same_seed_gives_the_same_recording_and_another_another(servo):
    case = JointCase(effects={"coulomb_friction": {}}, **SHORT)
    first, again, other = (record_case(case, servo, seed)[0].frame for seed in (3, 3, 4))
    pd.testing.assert_frame_equal(first, again)
    assert not first["position"].equals(other["position"])


def test_twins_have_the_same_instants_and_the_same_noise(servo):
    null = record_case(JointCase(**SHORT, jitter=1e-4), servo, seed=3)[0]
    twin = record_case(JointCase(effects={"backlash": {}}, **SHORT, jitter=1e-4), servo, seed=3)[0]
    assert null.runs == twin.runs
    assert null.frame["t"].equals(twin.frame["t"])
    apart = (null.frame["position"] - twin.frame["position"]).abs().max()
    assert 0 < apart < 0.3
    with_current = record_case(JointCase(**SHORT, jitter=1e-4, channels=["current"]), servo, seed=3)[0]
    pd.testing.assert_frame_equal(with_current.frame.drop(columns="current"), null.frame)


def test_the_record_carries_the_hash_of_the_key_and_nothing_of_its_content(servo):
    recording, key = record_case(JointCase(effects={"backlash": {}}, **SHORT), servo, seed=3)
    assert hashlib.sha256(key_text(key).encode()).hexdigest() in recording.source
    assert "backlash" not in recording.source


@pytest.mark.slow
@pytest.mark.parametrize("name", CONCEALABLE)
def test_the_key_speaks_the_language_of_the_catalogue(servo, told, name):
    machine = told if name in NEEDS_CONTROLLER else servo
    _, key = record_case(JointCase(effects={name: {}}, **SHORT), machine, seed=1)
    (entry,) = key["effects"]
    effect = next(effect for effect in effects_of("joint") if effect.name == name)
    assert entry["name"] == name
    assert set(entry["parameters"]) == {parameter.name for parameter in effect.parameters}
    for parameter in effect.parameters:
        stated = entry["parameters"][parameter.name]
        assert stated["unit"] == effect.units()[parameter.name]
        assert parameter.low <= stated["value"] <= parameter.high


@pytest.mark.parametrize("ratio", [1.0, 1.2])
def test_a_dead_zone_is_stated_as_the_effort_of_the_motor_that_is_there(servo, ratio):
    effects = {"dead_zone": {"width": 0.5}, "motor_constant_error": {"ratio": ratio}}
    _, key = record_case(JointCase(effects=effects, **SHORT), servo, seed=1)
    stated = {entry["name"]: entry["parameters"] for entry in key["effects"]}["dead_zone"]["width"]
    motor = servo.motor
    torque = ratio * motor.torque_constant * motor.gear_ratio * 0.5 / motor.resistance
    assert stated == {"value": pytest.approx(torque), "unit": "N·m"}


def test_what_is_outside_has_no_name_in_the_catalogue(servo):
    assert not set(OUTSIDE) & {effect.name for effect in effects_of("joint")}
    _, key = record_case(JointCase(outside={"tight_spot": {}}, **SHORT), servo, seed=1)
    assert key["effects"] == []
    assert [entry["name"] for entry in key["outside"]] == ["tight_spot"]


SENSORS = ("sensor_time_offset", "velocity_filter")


@pytest.fixture(scope="module")
def nulls(servo, told):
    """What the machines do with nothing concealed, with an input of their own and told a position."""
    return [record_case(JointCase(**SHORT, sensors=PERFECT), each, seed=1)[0].frame for each in (servo, told)]


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in CONCEALABLE if name not in SENSORS])
def test_every_effect_moves_the_machine_elsewhere(servo, told, nulls, name):
    machine = told if name in NEEDS_CONTROLLER else servo
    null = nulls[name in NEEDS_CONTROLLER]
    moved = record_case(JointCase(effects={name: {}}, **SHORT, sensors=PERFECT), machine, seed=1)[0].frame
    assert (moved["position"] - null["position"]).abs().max() > 3e-4


@pytest.mark.parametrize("name", OUTSIDE)
def test_everything_outside_the_catalogue_does_too(servo, nulls, name):
    null = nulls[0]
    outside = {name: {"position": 0.2} if name == "hard_stop" else {}}
    moved = record_case(JointCase(outside=outside, **SHORT, sensors=PERFECT), servo, seed=1)[0].frame
    assert (moved["position"] - null["position"]).abs().max() > 3e-4


@pytest.mark.parametrize("velocity_window", [0.0, 0.02])
def test_the_recording_keeps_the_contract_without_a_doubt(machine, velocity_window, tmp_path):
    case = case_for(machine, runs=3, duration=4.0)
    case.sensors = JointSensors(velocity_window=velocity_window, position=1e-5, position_step=1e-5)
    recording, _ = record_case(case, machine, seed=2)
    assert recording.units["position"] == ("m" if case.sliding else "rad")
    assert_read_as_written(recording, tmp_path)


def test_a_sliding_axis_states_metres(machine):
    if machine.motor is not None or machine.gravity_torque:
        pytest.skip("turns")
    _, key = record_case(sliding_case(effects={"viscous_friction": {}}, **SHORT), machine, seed=2)
    assert key["effects"][0]["parameters"]["coefficient"]["unit"] == "N·s/m"


def test_a_time_offset_shifts_the_motion_and_not_the_input(servo):
    plain = record_case(JointCase(runs=1, duration=2.0, dropped=0.0, sensors=PERFECT), servo, seed=1)[0].frame
    effects = {"sensor_time_offset": {"offset": 0.02}}
    late = record_case(
        JointCase(effects=effects, runs=1, duration=2.0, dropped=0.0, sensors=PERFECT), servo, seed=1
    )[0].frame
    np.testing.assert_allclose(late["position"][4:], plain["position"][:-4], atol=1e-9)
    np.testing.assert_array_equal(late["voltage"], plain["voltage"])


def test_a_filter_delays_the_velocity_and_nothing_else(servo):
    case = {"runs": 1, "duration": 2.0, "dropped": 0.0, "rate": 1000.0, "sensors": PERFECT}
    plain = record_case(JointCase(**case), servo, seed=1)[0].frame
    effects = {"velocity_filter": {"time_constant": 0.02}}
    late, key = record_case(JointCase(effects=effects, **case), servo, seed=1)
    for name in ("position", "voltage"):
        np.testing.assert_array_equal(late.frame[name], plain[name])
    velocity = late.frame["velocity"].to_numpy()
    errors = [
        np.square(velocity[100:] - plain["velocity"].to_numpy()[100 - n : -n]).mean() for n in range(1, 60)
    ]
    assert 1 + int(np.argmin(errors)) == pytest.approx(20, abs=3)
    assert key["effects"][0]["parameters"]["time_constant"]["value"] == pytest.approx(0.02, rel=0.15)


def test_samples_are_lost_and_the_battery_is_recorded_on_request(servo):
    case = JointCase(channels=["battery_voltage", "temperature"], dropped=0.1, runs=2, duration=4.0)
    frame = record_case(case, servo, seed=1)[0].frame
    assert 0.85 * 1600 < len(frame) < 0.95 * 1600
    assert {"battery_voltage", "temperature"} <= set(frame)
    assert "current" not in frame


def test_an_effect_of_the_voltage_needs_a_motor(machine):
    case = case_for(machine, effects={NEEDS_MOTOR[0]: {}}, **SHORT)
    if machine.motor is None:
        with pytest.raises(InputError, match="needs a motor"):
            record_case(case, machine, seed=0)
    else:
        assert record_case(case, machine, seed=0)[1]["effects"]


@pytest.mark.parametrize(
    ("case", "message"),
    [
        (JointCase(effects={"coulomb_frction": {}}), "did you mean 'coulomb_friction'"),
        (JointCase(effects={"coulomb_friction": {"levl": 1.0}}), "did you mean 'level'"),
        (JointCase(effects={"coulomb_friction": {"level": -1.0}}), "record.effects.coulomb_friction.level"),
        (JointCase(outside={"wear": {"growth": -1.0}}), "record.outside.wear.growth"),
        (JointCase(references=["jump"]), "record.references"),
        (JointCase(references=[]), "record.references"),
        (JointCase(channels=["smell"]), "record.channels"),
        (JointCase(without=["position"]), "record.without"),
        (JointCase(runs=0), "record.runs"),
        (JointCase(rate=5000.0), "record.rate"),
        (JointCase(gentlest=0.0), "record.gentlest"),
        (JointCase(dropped=1.0), "record.dropped"),
        (JointCase(jitter=0.01), "record.jitter"),
        (JointCase(sensors=JointSensors(current=-1.0)), "record.sensors.current"),
        (JointCase(effects={"backlash": {}, "flexible_coupling": {}}), "excludes backlash"),
    ],
)
def test_a_case_that_cannot_be_run_is_refused_by_its_key(servo, case, message):
    with pytest.raises(InputError, match=message):
        record_case(case, servo, seed=0)


def test_a_case_of_another_machine_is_refused(racer):
    with pytest.raises(InputError, match="another machine than a quadrotor"):
        record_case(JointCase(), racer, seed=0)
