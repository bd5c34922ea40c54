"""Sparse tables with the contract's columns: commands hold, measurements are interpolated, full tables stay."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from simgap.errors import InputError
from simgap.logs.opening import open_recording


def full(runs: int = 2, samples: int = 100) -> pd.DataFrame:
    time = np.tile(np.arange(samples) * 0.02, runs)
    return pd.DataFrame(
        {
            "run": np.repeat([f"run{number}" for number in range(runs)], samples),
            "t": time,
            "position": np.sin(time),
            "velocity": np.cos(time),
            "voltage": np.where(time < 1.0, 1.0, -2.0),
        }
    )


def sparse(frame: pd.DataFrame) -> pd.DataFrame:
    """Return rows of position, rows of velocity a millisecond later, and the voltage on change only."""
    late = frame.assign(t=frame["t"] + 0.001, velocity=np.cos(frame["t"] + 0.001))
    changed = (frame["voltage"] != frame["voltage"].shift()) | (frame["run"] != frame["run"].shift())
    rows = [
        frame[["run", "t", "position"]],
        late[["run", "t", "velocity"]],
        frame.loc[changed, ["run", "t", "voltage"]],
    ]
    return pd.concat(rows).sort_values(["run", "t"], kind="stable")


@pytest.mark.parametrize("suffix", ["csv", "parquet"])
def test_a_sparse_table_is_the_full_one(tmp_path: Path, suffix: str) -> None:
    frame = full()
    path = tmp_path / f"log.{suffix}"
    table = sparse(frame)
    table.to_csv(path, index=False) if suffix == "csv" else table.to_parquet(path, index=False)
    recording = open_recording(path, "joint")
    assert recording.runs == ["run0", "run1"]
    for name, rows in recording.frame.groupby("run"):
        whole = frame[(frame["run"] == name) & (frame["t"] > 0)]
        place = [round(time / 0.02) for time in rows["t"] + 0.02]
        assert len(rows) >= len(whole) - 1
        np.testing.assert_allclose(
            rows["voltage"].to_numpy(), np.where(np.array(place) < 50, 1.0, -2.0)[: len(rows)]
        )
        np.testing.assert_allclose(rows["velocity"], np.cos(rows["t"] + 0.02), atol=1e-3)
    assert any(
        "Held until the next value, as commands are: 'voltage' 4 of" in said for said in recording.warnings
    )


def test_a_full_table_with_gaps_is_left_to_cleaning(tmp_path: Path) -> None:
    frame = full()
    frame.loc[10:20, "velocity"] = np.nan
    path = tmp_path / "log.csv"
    frame.to_csv(path, index=False)
    recording = open_recording(path, "joint")
    assert recording.frame["velocity"].isna().sum() == 11
    assert not any("sparse" in said for said in recording.warnings)


def test_a_column_without_any_value_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    full().assign(voltage=np.nan).to_csv(path, index=False)
    with pytest.raises(InputError, match=r"'voltage'.*has no values"):
        open_recording(path, "joint")
