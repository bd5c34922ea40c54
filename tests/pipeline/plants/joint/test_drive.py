import numpy as np
import pytest

from simgap.plants.delay import Commands
from simgap.plants.joint.case import JointCase
from simgap.plants.joint.drive import drive_of
from simgap.plants.joint.motion import STEP
from simgap.plants.joint.supply import AMBIENT

STILL = np.zeros(1)


def drive(servo, **effects):
    case = JointCase(effects=effects, runs=1)
    return drive_of(case.concealed(servo)[0], servo, case, np.random.default_rng(0))


def test_without_effects_it_is_the_nominal_motor(servo):
    constant = servo.motor.torque_constant * servo.motor.gear_ratio
    effort = drive(servo).effort(np.array([6.0]), np.array([2.0]), STEP)
    assert effort[0] == pytest.approx(constant * (6.0 - constant * 2.0) / servo.motor.resistance, rel=1e-12)


def test_a_dead_zone_swallows_small_commands_and_shortens_others(servo):
    motor = drive(servo, dead_zone={"width": 0.5})
    assert motor.effort(np.array([0.4]), STILL, STEP)[0] == 0.0
    assert motor.effort(np.array([-2.5]), STILL, STEP)[0] == pytest.approx(
        drive(servo).effort(np.array([-2.0]), STILL, STEP)[0]
    )


def test_the_command_that_acts_is_greater_by_its_scale(servo):
    scaled = drive(servo, input_scale_error={"ratio": 1.25}).effort(np.array([4.0]), STILL, STEP)
    assert scaled[0] == pytest.approx(drive(servo).effort(np.array([5.0]), STILL, STEP)[0])


def test_a_slow_drive_covers_a_step_in_two_stages_and_lags_a_ramp_by_its_time_constant(servo):
    motor, per_volt = (
        drive(servo, motor_lag={"time_constant": 0.02}),
        drive(servo).effort(np.ones(1), STILL, STEP),
    )
    ramp = np.arange(1, 401) * STEP
    reached = [motor.effort(np.full(1, level), STILL, STEP)[0] / per_volt[0] for level in ramp]
    assert ramp[-1] - reached[-1] == pytest.approx(0.02, abs=1.1 * STEP)  # a step of it is the plant's own
    held = motor.effort(np.full(1, 5.0), STILL, 0.0)
    assert held[0] == pytest.approx(reached[-1] * per_volt[0], rel=1e-9)  # no time has passed


def test_the_current_rises_exponentially_through_an_inductance(servo):
    motor = drive(servo, motor_inductance={"time_constant": 0.01})
    for _ in range(20):
        motor.effort(np.array([4.6]), STILL, STEP)
    assert motor.current[0] == pytest.approx(2.0 * (1.0 - np.exp(-2.0)), rel=1e-12)


def test_the_current_stays_under_its_limit(servo):
    motor = drive(servo, current_limit={"limit": 1.5})
    motor.effort(np.array([-12.0]), STILL, STEP)
    assert motor.current[0] == -1.5


def test_warmth_weakens_and_work_warms(servo):
    motor = drive(servo, temperature_derating={"coefficient": 0.005})
    motor.winding.temperature[:] = AMBIENT
    cold = motor.effort(np.array([6.0]), STILL, STEP)[0]
    warmer = motor.winding.temperature[0]
    assert warmer > AMBIENT
    motor.winding.temperature[:] = AMBIENT + 40.0
    assert motor.effort(np.array([6.0]), STILL, STEP)[0] == pytest.approx(0.8 * cold, rel=0.05)


def test_the_battery_gives_way_under_load_and_recovers(servo):
    motor = drive(servo, battery_sag={"drop": 0.2})
    motor.effort(STILL, STILL, STEP)
    rested = motor.voltage[0]
    for _ in range(2000):
        motor.effort(np.array([12.0]), STILL, STEP)
    assert motor.voltage[0] < 0.8 * rested
    for _ in range(40_000):
        motor.effort(STILL, STILL, STEP)
    assert motor.voltage[0] == pytest.approx(rested, rel=1e-3)


def test_only_a_drive_that_passes_the_sag_on_gives_less_effort(servo):
    def after_work(**effects):
        motor = drive(servo, **effects)
        for _ in range(2000):
            effort = motor.effort(np.array([6.0]), STILL, STEP)
        return effort[0]

    assert after_work(battery_sag={"drop": 0.2, "charge": 0.15}) < 0.95 * after_work()
    assert after_work() == pytest.approx(drive(servo).effort(np.array([6.0]), STILL, STEP)[0])


def test_commands_arrive_late():
    commands = Commands(delay=4.5e-3, step=STEP, shape=(20, 1))
    for count in range(11):
        commands.note(count, np.array([float(count)]))
    assert commands.at(10)[0] == pytest.approx(5.5)
    assert commands.at(2)[0] == 0.0
