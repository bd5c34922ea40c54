"""A clock that starts anew is another run; rows are never sorted by time."""

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simgap.errors import InputError
from simgap.recordings import read_recording
from simgap.recordings.clocks import runs_of_one_clock


@given(st.lists(st.integers(20, 60), min_size=1, max_size=5))
def test_every_stretch_of_increasing_times_is_a_run(lengths):
    time = pd.Series(np.concatenate([np.arange(length) * 0.01 for length in lengths]))
    runs, remarks = runs_of_one_clock(pd.Series(["a"] * len(time)), time)
    assert runs.nunique() == len(lengths)
    assert list(runs.value_counts(sort=False)) == lengths
    assert bool(remarks) == (len(lengths) > 1)


def test_a_reset_makes_two_runs_and_says_so(frames, tmp_path):
    frame = frames(runs=2, samples=100)
    frame.loc[50:99, "t"] -= frame.loc[50, "t"]
    frame.to_parquet(tmp_path / "a.parquet")
    recording = read_recording(tmp_path / "a.parquet")
    assert recording.runs == ["run0", "run0 (2)", "run1"]
    assert "The clock of run 'run0' starts anew at row 51: it was taken as two runs" in recording.warnings[0]
    assert (recording.frame.groupby("run")["t"].diff().dropna() > 0).all()


@pytest.mark.parametrize(("repeated", "advice"), [(True, "two sources"), (False, "do not sort by time")])
def test_what_is_out_of_order_is_refused_with_the_right_advice(frames, tmp_path, repeated, advice):
    frame = frames(samples=100)
    if repeated:
        frame = frame.loc[frame.index.repeat(2)]
    else:
        frame.loc[50, "t"] = frame.loc[10, "t"]
    frame.to_parquet(tmp_path / "a.parquet")
    with pytest.raises(InputError, match=advice):
        read_recording(tmp_path / "a.parquet")
