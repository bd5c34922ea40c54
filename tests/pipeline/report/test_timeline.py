import numpy as np
import pandas as pd
from hypothesis import given
from hypothesis import strategies as st

from simgap.report.timeline import simplified, timeline


def stretches(lengths: list[float], states: list[str]) -> pd.DataFrame:
    edges = 100.0 + np.concatenate([[0.0], np.cumsum(lengths)])
    return pd.DataFrame({"run": "a", "start": edges[:-1], "end": edges[1:], "state": states, "reason": "why"})


@given(st.lists(st.floats(0.01, 10), min_size=1, max_size=50))
def test_few_stretches_are_drawn_as_they_are(lengths):
    states = ["kept", "dropped"] * (len(lengths) // 2) + ["kept"] * (len(lengths) % 2)
    seen = simplified(stretches(lengths, states))
    assert seen["state"].tolist() == states
    assert seen["start"].iloc[0] == 0
    np.testing.assert_allclose(seen["end"] - seen["start"], lengths, rtol=1e-6, atol=1e-9)


def test_many_stretches_keep_each_state_its_share_of_the_time():
    random = np.random.default_rng(3)
    lengths = np.ravel([random.exponential(0.03, 5000), random.exponential(0.01, 5000)], order="F")
    seen = simplified(stretches(lengths.tolist(), ["kept", "interpolated"] * 5000))
    spans = (seen["end"] - seen["start"]).groupby(seen["state"]).sum()
    assert len(seen) <= 300
    np.testing.assert_allclose(spans.sum(), lengths.sum(), rtol=1e-9)
    assert abs(spans["kept"] / spans.sum() - 0.75) < 0.08


def test_a_state_that_nobody_knows_is_drawn_after_the_others():
    table = stretches([1.0, 2.0, 3.0], ["simulated", "dropped", "kept"])
    drawn = timeline(table, {"a": "train"})
    assert [state for state, _ in drawn.legend] == ["kept", "dropped", "simulated"]
    ((run, part, bars),) = drawn.rows
    assert (run, part) == ("a", "train")
    np.testing.assert_allclose([bar["width"] for bar in bars], [166.67, 333.33, 500.0], atol=0.01)
    assert bars[0]["said"] == "simulated for 1 s from 0 s: why"


@given(st.floats(0.01, 1e5))
def test_ticks_are_few_round_and_within_the_axis(longest):
    drawn = timeline(stretches([longest], ["kept"]), {})
    assert 1 < len(drawn.ticks) <= 7
    assert drawn.ticks[0] == (0.0, "0")
    assert all(0 <= place <= 100 for place, _ in drawn.ticks)
