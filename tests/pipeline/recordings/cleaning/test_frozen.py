import numpy as np
import pytest

from simgap.recordings.cleaning.channels import BODY_RATE, MOTOR_SPEED, POSITION, VELOCITY
from simgap.recordings.cleaning.frozen import erase_frozen

STATE = [*POSITION, *VELOCITY, *BODY_RATE, *(f"attitude_{axis}" for axis in "wxyz")]
MAX_GAP = 0.1


def hold(frame, rows, columns):
    frame.loc[rows, columns] = np.nan
    frame[columns] = frame[columns].ffill()


def erased(run, column):
    return np.flatnonzero(np.isnan(run.channel(column)[:, 0])).tolist()


def test_a_quarter_of_held_samples_is_found_per_message(flight, as_run):
    frame = flight()
    random = np.random.default_rng(1)
    state = np.sort(random.choice(np.arange(1, 1200), 320, replace=False)).tolist()
    motors = np.sort(random.choice(np.arange(1, 1200), 200, replace=False)).tolist()
    hold(frame, state, STATE)
    hold(frame, motors, MOTOR_SPEED)
    run = as_run(frame, "quadrotor")
    erase_frozen(run, MAX_GAP)
    assert erased(run, "velocity_x") == erased(run, "attitude_w") == state
    assert erased(run, "motor_speed_3") == motors
    assert erased(run, "specific_force_x") == []


def test_a_long_freeze_is_found(flight, as_run):
    frame = flight()
    hold(frame, range(400, 600), STATE)
    run = as_run(frame, "quadrotor")
    erase_frozen(run, MAX_GAP)
    assert erased(run, "position_x") == list(range(400, 600))


def test_an_acceleration_held_in_world_axes_is_found_in_body_axes(flight, as_run):
    from scipy.spatial.transform import Rotation

    frame = flight()
    attitude = Rotation.from_quat(
        frame[[f"attitude_{axis}" for axis in "wxyz"]].to_numpy(copy=True), scalar_first=True
    )
    columns = [f"specific_force_{axis}" for axis in "xyz"]
    world = attitude.apply(frame[columns].to_numpy(copy=True))
    rows = [50, 200, 201, 900]
    for row in rows:
        world[row] = world[row - 1]
    frame[columns] = attitude.inv().apply(world)
    run = as_run(frame, "quadrotor")
    erase_frozen(run, MAX_GAP)
    assert erased(run, "specific_force_y") == rows


def test_standstill_is_left(joint, as_run):
    """Braked to rest, held there by friction, and off again: position and velocity repeat, and truly so."""
    frame = joint()
    frame.loc[200:400, "velocity"] = 0.0
    frame.loc[200:400, "position"] = frame.loc[200, "position"]
    run = as_run(frame, "joint")
    erase_frozen(run, MAX_GAP)
    assert not run.changes


def test_a_slow_quantised_motion_is_left(joint, as_run):
    frame = joint()
    frame["position"] = np.round(frame["t"] * 0.02 / 1e-3) * 1e-3
    frame["velocity"] = np.round(0.02 + 1e-3 * np.random.default_rng(0).standard_normal(len(frame)), 2)
    run = as_run(frame, "joint")
    erase_frozen(run, MAX_GAP)
    assert not run.changes


def test_held_inputs_and_constants_are_left(joint, as_run):
    frame = joint()
    frame["voltage"] = 7.0
    frame["battery_voltage"] = np.repeat(12 - 0.1 * np.random.default_rng(0).random(60), 10)
    run = as_run(frame, "joint")
    erase_frozen(run, MAX_GAP)
    assert not run.changes


def test_a_message_logged_at_a_lower_rate_is_left_and_said(flight, as_run):
    frame = flight()
    hold(frame, [row for row in range(1, 1200) if row % 4], MOTOR_SPEED)
    run = as_run(frame, "quadrotor")
    erase_frozen(run, MAX_GAP)
    assert [change["reason"] for change in run.changes] == ["logged at a lower rate, kept"]
    assert erased(run, "motor_speed_1") == []


@pytest.mark.parametrize("length", [3, 40])
def test_commands_at_their_limit_are_left(flight, as_run, length):
    frame = flight()
    random = np.random.default_rng(0)
    for rotor in range(1, 5):
        frame[f"motor_command_{rotor}"] = np.clip(0.6 + 0.1 * random.standard_normal(len(frame)), 0.1, 1.0)
        frame.loc[300 : 300 + length, f"motor_command_{rotor}"] = 1.0
    run = as_run(frame.drop(columns=MOTOR_SPEED), "quadrotor")
    erase_frozen(run, MAX_GAP)
    assert not run.changes
