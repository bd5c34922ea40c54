"""What holds for the recording of every concealed machine once it is on disk."""

from pathlib import Path

import pandas as pd

from simgap.recordings.recording import Recording, read_recording, write_recording


def assert_read_as_written(recording: Recording, folder: Path) -> None:
    """Nothing changes on disk, and reading warns of nothing."""
    write_recording(recording, folder / "recording.parquet")
    read = read_recording(folder / "recording.parquet")
    pd.testing.assert_frame_equal(read.frame, recording.frame, check_like=True)
    assert read.kind == recording.kind
    assert read.units == recording.units
    assert read.warnings == ()
