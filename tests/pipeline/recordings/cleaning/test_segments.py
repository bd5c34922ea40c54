import numpy as np

from simgap.recordings.cleaning.segments import (
    drop_incomplete,
    drop_made_up,
    drop_short,
    segment_numbers,
    unbroken,
)


def test_samples_without_a_needed_channel_go_and_those_without_an_optional_one_stay(joint, as_run):
    frame = joint()
    frame["battery_voltage"] = np.nan
    frame.loc[100:199, "velocity"] = np.nan
    run = as_run(frame, "joint")
    drop_incomplete(run)
    assert np.flatnonzero(run.dropped > 0).tolist() == list(range(100, 200))
    assert unbroken(run).tolist() == [[0, 100], [200, 600]]
    assert set(segment_numbers(run)[200:]) == {1}


def test_stretches_that_are_too_short_go(joint, as_run):
    run = as_run(joint(), "joint")
    rows = np.zeros(len(run.time), dtype=bool)
    rows[[100, 110, 121]] = True  # leaves 9 and 10 samples between
    run.drop(rows, "gaps", "test")
    drop_short(run, 0.1)
    assert (run.dropped[101:110] > 0).all()
    assert (run.dropped[111:121] == 0).all()


def test_a_stretch_that_is_mostly_interpolated_goes(joint, as_run):
    run = as_run(joint(), "joint")
    run.stretch[300:] = 1
    run.cause[:200, 0] = run.number("frozen")
    drop_made_up(run, 0.5)
    assert (run.dropped[:300] > 0).all()
    assert (run.dropped[300:] == 0).all()
