"""Channels are the recording's own until they are changed; neither shows what becomes of the other."""

import numpy as np
import pandas as pd

from simgap.recordings.cleaning import clean_recording
from simgap.recordings.cleaning.table import ChannelTable
from tests.pipeline.recordings.cleaning.conftest import flight_frame, recording_of


def test_a_channel_is_copied_before_it_is_changed():
    frame = pd.DataFrame({"one": np.arange(4.0), "other": np.arange(4.0)})
    table = ChannelTable.of(frame, ["one", "other"])
    table.own(0)[1] = np.nan
    assert frame["one"].tolist() == [0.0, 1.0, 2.0, 3.0]
    assert np.isnan(table.arrays[0][1])
    assert not np.shares_memory(table.arrays[0], frame["one"].to_numpy())
    assert np.shares_memory(table.arrays[1], frame["other"].to_numpy())


def test_other_numbers_are_converted():
    frame = pd.DataFrame({"whole": np.arange(3), "small": np.arange(3, dtype="f4")})
    table = ChannelTable.of(frame, ["whole", "small"])
    assert all(array.dtype == np.float64 for array in table.arrays)
    assert table.shared == [None, None]


def test_a_cleaned_recording_shares_what_is_unchanged_and_stays_as_it_is():
    recording = recording_of(flight_frame(), "quadrotor")
    cleaned, _ = clean_recording(recording)
    before = cleaned.frame.copy(deep=True)
    assert np.shares_memory(cleaned.frame["position_x"].to_numpy(), recording.frame["position_x"].to_numpy())
    recording.frame.loc[:, ["t", "position_x"]] = 0.0
    pd.testing.assert_frame_equal(cleaned.frame, before)
