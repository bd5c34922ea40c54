"""Summary of cleaning, one line per run."""

import numpy as np
import pandas as pd

from simgap.recordings.cleaning.clean import Cleaned
from simgap.recordings.recording import Recording


def summary(recording: Recording, cleaned: Cleaned) -> pd.DataFrame:
    """Count samples per run.

    Args:
        recording: as it was before.
        cleaned: what became of it.

    Returns:
        Indexed by run: samples `recorded`, by how many resampling made them more (`resampled`), `dropped` and
        `kept` (recorded + resampled − dropped = kept), `interpolated` of those kept in some needed channel,
        the number of unbroken `segments`, the `part` of the split and the `clock_offset_ms`, NaN where it
        is unknown.
    """
    runs = recording.runs
    rows = cleaned.changes[cleaned.changes["column"] == ""]
    resampled = rows["step"] == "resample"
    kept = cleaned.recording.frame.groupby("run", sort=False)
    step = cleaned.recording.time_step
    filled = cleaned.coverage[cleaned.coverage["state"] == "interpolated"]
    lengths = ((filled["end"] - filled["start"]) / step).round().groupby(filled["run"]).sum()
    columns = {
        "recorded": recording.frame.groupby("run", sort=False).size(),
        "resampled": rows[resampled].groupby("run")["samples"].sum(),
        "dropped": -rows[~resampled].groupby("run")["samples"].sum(),
        "kept": kept.size(),
        "interpolated": lengths,
        "segments": kept["segment"].nunique() if "segment" in cleaned.recording.frame else 1,
    }
    table = pd.DataFrame(columns, index=pd.Index(runs, name="run")).fillna(0).astype("int64")
    table["part"] = [cleaned.recording.split.get(run, "dropped") for run in runs]
    offsets = cleaned.recording.clock_offset
    table["clock_offset_ms"] = [1e3 * offsets.get(run, np.nan) for run in runs]
    return table
