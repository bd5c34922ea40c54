import numpy as np

from simgap.recordings.cleaning.idle import drop_idle


def dropped(run):
    return np.flatnonzero(run.dropped > 0).tolist()


def test_standing_on_the_floor_before_and_after_the_flight_is_dropped(flight, as_run):
    frame = flight()
    ground = (frame["t"] < 2.0) | (frame["t"] >= 10.0)
    frame.loc[ground, "position_z"] = 0.05
    frame.loc[ground, [f"velocity_{axis}" for axis in "xyz"]] = 0.0
    frame.loc[ground, [f"body_rate_{axis}" for axis in "xyz"]] = 0.0
    # idling before take-off, off after landing
    frame.loc[frame["t"] >= 10.0, [f"motor_speed_{rotor}" for rotor in "1234"]] = 0.0
    run = as_run(frame, "quadrotor")
    drop_idle(run, 0.5)
    assert dropped(run) == [*range(200), *range(1000, 1200)]


def test_a_hover_low_above_the_floor_is_left(flight, as_run):
    frame = flight()
    frame["position_z"] = 0.1 + 0.01 * np.sin(frame["t"])
    run = as_run(frame, "quadrotor")
    drop_idle(run, 0.5)
    assert dropped(run) == []


def test_a_short_cut_of_the_rotors_in_flight_is_left(flight, as_run):
    frame = flight()
    frame.loc[500:580, [f"motor_speed_{rotor}" for rotor in "1234"]] = 300.0
    run = as_run(frame, "quadrotor")
    drop_idle(run, 0.5)
    assert dropped(run) == []


def test_no_voltage_and_no_motion_is_idle_but_either_is_not(joint, as_run):
    frame = joint()
    frame.loc[100:199, ["voltage", "velocity"]] = 0.0  # rest
    frame.loc[300:399, "voltage"] = 0.0  # coasting
    frame.loc[450:549, "velocity"] = 0.0  # stuck under voltage
    frame.loc[580:590, ["voltage", "velocity"]] = 0.0  # too short to mention
    run = as_run(frame, "joint")
    drop_idle(run, 0.5)
    assert dropped(run) == list(range(100, 200))


def test_a_swerve_is_idle_only_when_every_motor_is(frames, as_run):
    frame = frames("swerve", runs=1, samples=600)
    inputs = [column for column in frame if "voltage" in column or "velocity" in column]
    frame.loc[100:199, inputs] = 0.0
    frame.loc[300:399, [column for column in inputs if column != "steer_voltage_3"]] = 0.0
    run = as_run(frame, "swerve")
    drop_idle(run, 0.5)
    assert dropped(run) == list(range(100, 200))


def test_samples_cut_out_of_a_rest_do_not_shorten_it(joint, as_run):
    frame = joint()
    frame.loc[100:199, ["voltage", "velocity"]] = 0.0
    run = as_run(frame, "joint")
    gap = np.zeros(len(frame), dtype=bool)
    gap[140:160] = True
    run.drop(gap, "gaps", "test")
    drop_idle(run, 0.8)
    assert dropped(run) == list(range(100, 200))
