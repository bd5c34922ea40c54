"""The clock and the runs of a table."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simgap.errors import InputError
from simgap.logs.apply import recording_of
from simgap.logs.mapping import mapping_from_config
from simgap.logs.table_clock import with_clock
from simgap.logs.tabular import log_of_table

COLUMNS = {"kind": "joint", "position": "p", "velocity": "v", "voltage": "u"}


def frame(**columns: object) -> pd.DataFrame:
    return pd.DataFrame(columns)


@given(lengths=st.lists(st.integers(2, 20), min_size=1, max_size=6), seed=st.integers(0, 100))
def test_interleaved_runs_are_put_one_behind_the_other(lengths: list[int], seed: int) -> None:
    names = np.repeat([f"run{k}" for k in range(len(lengths))], lengths)
    time = np.concatenate([np.arange(length) * 0.1 for length in lengths])
    # rows of different runs change places; within a run they stay in order
    order = np.argsort(np.random.default_rng(seed).random(len(names)) + 11 * time, kind="stable")
    log = log_of_table(frame(name=names[order], t=time[order], p=time[order]), Path("log.csv"), "table")
    clocked, _ = with_clock(log, mapping_from_config({"kind": "joint", "t": "t", "run": "name"}))
    assert sorted(span.name for span in clocked.spans) == sorted(set(names))
    signal = clocked.signals["p"]
    assert (np.diff(signal.time) > 0).all()
    for span in clocked.spans:
        inside = (signal.time >= span.begin - 1e-9) & (signal.time <= span.end + 1e-9)
        np.testing.assert_allclose(signal.values[inside], np.arange(inside.sum()) * 0.1)


def test_numbers_name_runs_and_hold_over_empty_rows() -> None:
    log = log_of_table(frame(n=[1, np.nan, 2, np.nan], t=[0, 1, 0, 1], p=[1.0, 2, 3, 4]), Path("x"), "table")
    clocked, _ = with_clock(log, mapping_from_config({"kind": "joint", "t": "t", "run": "n"}))
    assert [span.name for span in clocked.spans] == ["1", "2"]


def test_a_column_that_goes_back_all_the_time_is_no_clock() -> None:
    log = log_of_table(frame(t=np.sin(np.arange(50.0)), p=np.arange(50.0)), Path("log.csv"), "table")
    with pytest.raises(InputError, match="goes back in"):
        with_clock(log, mapping_from_config({"kind": "joint", "t": "t"}))


def test_evenly_spaced_samples_need_a_rate_only() -> None:
    rows = np.arange(20.0)
    log = log_of_table(frame(p=rows, v=rows, u=rows), Path("log.csv"), "table")
    with pytest.raises(InputError, match="or rate: HERTZ"):
        recording_of(log, mapping_from_config(COLUMNS))
    recording = recording_of(log, mapping_from_config(COLUMNS | {"rate": 50}))
    np.testing.assert_allclose(recording.frame["t"], rows / 50)
    np.testing.assert_array_equal(recording.frame["voltage"], rows)


def test_a_position_that_was_not_logged_is_integrated_from_zero_in_each_run() -> None:
    time = np.tile(np.arange(50) * 0.1, 2)
    log = log_of_table(
        frame(t=time, v=30.0 * time, u=time, r=np.repeat(["a", "b"], 50)), Path("log.csv"), "table"
    )
    velocity = {"from": "v", "unit": "rpm"}
    mapping = mapping_from_config(
        COLUMNS | {"t": "t", "run": "r", "velocity": velocity, "position": velocity | {"integrate": True}}
    )
    recording = recording_of(log, mapping)
    np.testing.assert_allclose(recording.frame["position"], np.pi / 2 * time**2, atol=1e-9)
    assert any("integrated from 'v', from zero" in said for said in recording.warnings)
