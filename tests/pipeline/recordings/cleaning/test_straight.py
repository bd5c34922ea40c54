import numpy as np

from simgap.recordings.cleaning.channels import BODY_RATE
from simgap.recordings.cleaning.straight import erase_straight


def test_a_log_that_was_extrapolated_to_the_end_is_erased(flight, as_run):
    frame = flight()
    time = frame["t"].to_numpy()
    for slope, column in zip((0.5, -0.2, 0.1), BODY_RATE, strict=True):
        frame.loc[800:, column] = frame.loc[800, column] + slope * (time[800:] - time[800])
    run = as_run(frame, "quadrotor")
    erase_straight(run, 0.1)
    gone = np.isnan(run.channel(*BODY_RATE)).all(axis=1)
    assert np.flatnonzero(gone).tolist() == list(range(801, 1200))
    assert {change["column"] for change in run.changes} == set(BODY_RATE)


def test_what_a_gap_in_the_log_was_bridged_with_is_erased(flight, as_run):
    frame = flight()
    for column in BODY_RATE:
        frame.loc[500:530, column] = np.linspace(frame.loc[500, column], frame.loc[530, column], 31)
    run = as_run(frame, "quadrotor")
    erase_straight(run, 0.1)
    # the line's two ends are measurements
    assert (
        set(range(501, 530))
        <= set(np.flatnonzero(np.isnan(run.channel("body_rate_x")[:, 0])))
        <= set(range(501, 531))
    )


def test_short_lines_smooth_motion_and_constants_are_left(flight, as_run):
    frame = flight(noise=0.0)  # as a simulator records it
    frame.loc[500:508, BODY_RATE[0]] = np.linspace(0, 1, 9)
    frame.loc[700:900, BODY_RATE] = 0.25
    run = as_run(frame, "quadrotor")
    erase_straight(run, 0.1)
    assert not run.changes


def test_of_several_lines_those_that_bend_slowly_are_left(flight, as_run):
    frame = flight()
    bent = 0.5 + 0.2 * np.linspace(0, 1, 101) + 0.02 * np.linspace(0, 1, 101) ** 2
    lines = {200: np.linspace(0, 1, 31), 400: bent, 600: np.linspace(1, -1, 41), 800: np.linspace(0, 2, 21)}
    for first, line in lines.items():
        for share, column in enumerate(BODY_RATE, 1):
            frame.loc[first : first + len(line) - 1, column] = share * line
    run = as_run(frame, "quadrotor")
    erase_straight(run, 0.1)
    gone = set(np.flatnonzero(np.isnan(run.column("body_rate_x"))))
    for first, line in lines.items():
        inside = set(range(first + 1, first + len(line) - 1))
        assert inside <= gone if first != 400 else not inside & gone
