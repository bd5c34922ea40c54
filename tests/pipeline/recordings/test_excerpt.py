import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as some

from simgap.errors import InputError
from simgap.recordings.excerpt import evenly, first_seconds, of_runs
from simgap.recordings.recording import Recording


@pytest.fixture
def recording():
    """Return two runs of five seconds, 10 Hz."""
    time = 0.1 * np.arange(50)
    runs = [pd.DataFrame({"run": run, "t": time, "position": time}) for run in ("a", "b")]
    return Recording(pd.concat(runs, ignore_index=True), "joint", {"position": "rad"}, cleaned=True)


@given(some.integers(1, 5000), some.integers(1, 5000))
def test_places_are_as_many_as_wanted_in_order_and_from_one_end_to_the_other(total, most):
    places = evenly(total, most)
    assert len(places) == min(total, most)
    assert places[0] == 0
    assert most == 1 or places[-1] == total - 1
    gaps = np.diff(places)
    assert len(gaps) == 0 or (gaps.min() >= 1 and gaps.max() - gaps.min() <= 1)


def test_the_beginning_of_a_recording_goes_on_from_run_to_run(recording):
    frame = first_seconds(recording, 7.0).frame
    assert frame["run"].value_counts().to_dict() == {"a": 50, "b": 20}
    assert first_seconds(recording, None) is recording
    assert len(first_seconds(recording, 100.0).frame) == 100


def test_less_than_a_sample_is_refused(recording):
    with pytest.raises(InputError, match="hold no sample"):
        first_seconds(recording, 0.0)


def test_some_runs_of_a_recording(recording):
    chosen = of_runs(recording, ["b"])
    assert chosen.runs == ["b"]
    assert chosen.frame.index.tolist() == list(range(50))
