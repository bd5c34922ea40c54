import numpy as np
import pytest

from simgap.recordings.cleaning.channels import ATTITUDE
from simgap.recordings.cleaning.crash import cut_crash

MARGIN = 0.5


def kept_until(run):
    return run.time[np.flatnonzero(run.dropped == 0)[-1]]


def test_a_flight_without_a_crash_is_left(flight, as_run):
    run = as_run(flight(), "quadrotor")
    cut_crash(run, MARGIN)
    assert not run.changes


@pytest.mark.parametrize("sign", ["tumbling", "shock", "estimate lost", "upside down"])
def test_everything_from_shortly_before_a_crash_is_cut_off(flight, as_run, sign):
    frame = flight()
    if sign == "tumbling":
        frame.loc[1000:1020, "body_rate_x"] = 30.0
    elif sign == "shock":
        frame.loc[1000, "specific_force_z"] = 14 * 9.81
    elif sign == "estimate lost":
        frame.loc[1000:, "position_x"] += 6.0
    else:
        frame.loc[1000:, ATTITUDE] = [0.0, 1.0, 0.0, 0.0]
    run = as_run(frame, "quadrotor")
    cut_crash(run, MARGIN)
    assert kept_until(run) == pytest.approx(10.0 - MARGIN - 0.01)
    (change,) = run.changes
    assert change["samples"] == -250
    assert "t = 10 s" in change["detail"]


def test_a_shock_from_which_the_flight_recovers_is_left(flight, as_run):
    frame = flight()
    frame.loc[500, "specific_force_z"] = 14 * 9.81
    frame.loc[500:505, "body_rate_x"] = 30.0
    run = as_run(frame, "quadrotor")
    cut_crash(run, MARGIN)
    assert not run.changes


def test_a_hard_landing_costs_no_flight(flight, as_run):
    frame = flight()
    frame["position_z"] = np.maximum(0.0, 1.0 - 0.2 * np.maximum(0.0, frame["t"] - 5.0))
    frame["velocity_z"] = np.gradient(frame["position_z"], frame["t"])
    frame.loc[1000, "specific_force_z"] = 50.0
    run = as_run(frame, "quadrotor")
    cut_crash(run, MARGIN)
    assert kept_until(run) == pytest.approx(9.94)
    assert run.changes[0]["reason"] == "on the ground after a hard landing"
