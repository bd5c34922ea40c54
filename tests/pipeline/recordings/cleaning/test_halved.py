"""Counted speeds that miss every other count, or all of them, for a while."""

import numpy as np
import pytest

from simgap.recordings.cleaning.dead import erase_dead
from simgap.recordings.cleaning.halved import mend_halved

SPOILT = slice(400, 480)


def test_a_speed_that_is_half_for_a_while_is_doubled(flight, as_run) -> None:
    frame = flight()
    spoilt = frame.copy()
    spoilt.loc[400:479, "motor_speed_3"] *= 0.5
    run = as_run(spoilt, "quadrotor")
    mend_halved(run)
    assert run.channel("motor_speed_3")[:, 0] == pytest.approx(frame["motor_speed_3"].to_numpy(), rel=1e-12)
    assert "falls to half" in run.remarks[0]
    assert [change["samples"] for change in run.changes] == [80]


def test_a_speed_that_is_zero_for_a_while_is_left_out(flight, as_run) -> None:
    frame = flight()
    frame.loc[400:479, "motor_speed_3"] = 0.0
    run = as_run(frame, "quadrotor")
    mend_halved(run)
    missing = np.isnan(run.channel("motor_speed_3")[:, 0])
    assert np.flatnonzero(missing).tolist() == list(range(400, 480))
    assert "falls to zero" in run.remarks[0]


def test_a_rotor_that_repeats_one_value_while_the_others_change_is_left_out(flight, as_run) -> None:
    frame = flight()
    frame.loc[400:479, "motor_speed_3"] = frame.loc[400, "motor_speed_3"]
    run = as_run(frame, "quadrotor")
    erase_dead(run)
    assert np.isnan(run.channel("motor_speed_3")[SPOILT, 0]).all()
    assert "repeats one value" in run.remarks[0]


@pytest.mark.parametrize("steps", [4, 10, 40])
def test_a_speed_that_falls_as_fast_as_a_motor_can_is_left_as_it_is(flight, as_run, steps: int) -> None:
    frame = flight()
    course = np.interp(np.arange(len(frame)), [400, 400 + steps, 480, 480 + steps], [1.0, 0.5, 0.5, 1.0])
    frame["motor_speed_3"] *= course
    run = as_run(frame, "quadrotor")
    before = run.values.copy()
    mend_halved(run)
    erase_dead(run)
    np.testing.assert_array_equal(run.values, before)
    assert run.changes == []


def test_all_rotors_that_stand_together_are_no_fault(flight, as_run) -> None:
    frame = flight()
    speeds = [f"motor_speed_{rotor}" for rotor in "1234"]
    frame.loc[400:479, speeds] = frame.loc[400, speeds].to_numpy()
    run = as_run(frame, "quadrotor")
    erase_dead(run)
    assert not np.isnan(run.channel(*speeds)).any()
