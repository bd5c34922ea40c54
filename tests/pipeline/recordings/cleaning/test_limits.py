import numpy as np

from simgap.recordings.cleaning.limits import erase_beyond_limits


def test_commands_outside_zero_to_one_are_erased_and_saturated_ones_left(flight, as_run):
    frame = flight()
    for rotor in range(1, 5):
        frame[f"motor_command_{rotor}"] = 1.0
    frame.loc[[10, 11], "motor_command_2"] = [19.0, -0.5]
    frame.loc[20, "motor_command_3"] = 1.0005
    run = as_run(frame, "quadrotor")
    erase_beyond_limits(run)
    assert np.flatnonzero(np.isnan(run.values).any(axis=1)).tolist() == [10, 11]
    (change,) = run.changes
    assert (change["column"], change["samples"], change["detail"]) == ("motor_command_2", 2, "up to 19")
