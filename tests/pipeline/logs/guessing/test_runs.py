"""Columns that divide a table into runs: known by what they say, sure where name or clock agree, else asked about."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from simgap.errors import InputError
from simgap.logs.apply import recording_of
from simgap.logs.guess import guess
from simgap.logs.guessing.clock import clock_of
from simgap.logs.opening import open_recording
from simgap.logs.proposal import SURE, Proposal
from simgap.logs.tabular import log_of_table
from tests.pipeline.logs.guessing.naming import motion

ROWS, RUNS = 200, 3


def joint(**columns: object) -> pd.DataFrame:
    """Return a joint's table of three stretches with a clock that goes on, and the columns that are given."""
    time, position, velocity = motion(np.random.default_rng(8), ROWS * RUNS)
    torque = 0.3 * np.sign(velocity) + 0.05 * velocity
    return pd.DataFrame(
        {"time_s": time, "pos_rad": position, "vel_rad_s": velocity, "torque_nm": torque} | columns
    )


def each(*values: object) -> np.ndarray:
    """Return values that last one stretch each."""
    return np.repeat(np.array(values, dtype=object if isinstance(values[0], str) else float), ROWS)


def restarted(frame: pd.DataFrame) -> pd.DataFrame:
    """Return a table whose clock starts anew in each stretch."""
    time = frame["time_s"].to_numpy().reshape(RUNS, ROWS)
    return frame.assign(time_s=(time - time[:, :1]).ravel())


def proposed(frame: pd.DataFrame) -> Proposal:
    return guess(log_of_table(frame, Path("log.csv"), "table"), None)


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("trial", ("a", "b", "c")),
        ("test_name", ("sine", "step", "chirp")),
        ("maneuver", ("hover", "climb", "turn")),
        ("Experiment", ("e1", "e2", "e3")),
        ("episode", (0, 1, 2)),
        ("lap", (1, 2, 3)),
        ("lapNumber", (4, 5, 6)),
    ],
)
def test_named_stretches_are_runs(name: str, values: tuple) -> None:
    frame = joint(**{name: each(*values)})
    proposal = proposed(frame)
    assert proposal.columns["run"].source.signal == name
    assert proposal.is_sure
    recording = recording_of(log_of_table(frame, Path("log.csv"), "table"), proposal.mapping())
    assert [str(run) for run in recording.runs] == [str(value) for value in values]
    assert len(recording.frame) == ROWS * RUNS


@pytest.mark.parametrize(
    ("name", "values"), [("label", ("x", "y", "z")), ("block", (0, 1, 2)), ("k", (1, 2, 3))]
)
def test_other_names_are_asked_about_unless_the_clock_agrees(name: str, values: tuple) -> None:
    frame = joint(**{name: each(*values)})
    asked = proposed(frame).columns["run"]
    assert (asked.source.signal, asked.confidence < SURE) == (name, True)
    assert "are they runs? Else delete this line" in asked.reason
    sure = proposed(restarted(frame))
    assert sure.columns["run"].source.signal == name
    assert sure.columns["run"].confidence >= SURE
    assert "the clock breaks off between them" in sure.columns["run"].reason
    assert sure.is_sure


def test_values_that_come_back_are_asked_about() -> None:
    found = proposed(joint(trial=each("a", "b", "a"))).columns["run"]
    assert found.confidence < SURE
    assert "come back, in 3 stretches" in found.reason


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("mode", each("idle", "drive", "brake")),
        ("state", each("a", "b", "c")),
        ("comment", each("ok", "ok", "ok")),
        ("setpoint_rpm", each(0, 1, 2)),
        ("payload", each(0, 5, 10)),
        ("winding_temp_C", each(0, 1, 2)),
        ("switch", np.repeat([0.0, 1.0], ROWS * RUNS // 2)),
        ("label", np.tile(np.array(["x", "y", "z"], dtype=object), ROWS)),
        ("lap", np.arange(ROWS * RUNS, dtype=float)),
        ("trial", np.linspace(0, 1, ROWS * RUNS)),
        ("stamp_sec", np.repeat(np.arange(6.0), 100)),
    ],
)
def test_what_changes_for_another_reason_is_no_run(name: str, values: np.ndarray) -> None:
    assert clock_of(log_of_table(joint(**{name: values}), Path("log.csv"), "table")).run is None


def test_of_two_columns_the_surer_one() -> None:
    frame = joint(experiment=each("a", "b", "c"), trial=np.tile(np.repeat([1.0, 2.0], 100), RUNS))
    assert proposed(frame).columns["run"].source.signal == "experiment"


def written(tmp_path: Path, **columns: object) -> Path:
    names = {"time_s": "t", "pos_rad": "position", "vel_rad_s": "velocity", "torque_nm": "effort"}
    path = tmp_path / "log.csv"
    joint(**columns).rename(columns=names).to_csv(path, index=False)
    return path


def test_a_table_with_the_names_of_the_contract_may_call_its_runs_otherwise(tmp_path: Path) -> None:
    recording = open_recording(written(tmp_path, maneuver=each("a", "b", "c")))
    assert recording.runs == ["a", "b", "c"]
    assert (
        "Column 'maneuver' is taken as the run: by its name, 3 runs one after another." in recording.warnings
    )


def test_a_table_with_the_names_of_the_contract_asks_where_runs_are_not_sure(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"'label' may be it .*give a mapping with run: label"):
        open_recording(written(tmp_path, label=each("a", "b", "c")))
    mapping = tmp_path / "mine.yaml"
    mapping.write_text("kind: joint\nrun: label\n")
    assert open_recording(written(tmp_path, label=each("a", "b", "c")), mapping=mapping).runs == [
        "a",
        "b",
        "c",
    ]
    with pytest.raises(InputError, match="column 'run' is missing; add it"):
        open_recording(written(tmp_path))
