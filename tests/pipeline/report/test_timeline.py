import numpy as np
import pandas as pd
from hypothesis import given
from hypothesis import strategies as st

from simgap.report.timeline import simplified, timeline
from tests.pipeline.report.decode import decode


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
    assert [trace["name"] for trace in drawn.data] == ["kept", "dropped", "simulated"]
    assert [float(decode(trace["x"]).sum()) for trace in drawn.data] == [3.0, 2.0, 1.0]
    assert drawn.layout["yaxis"]["ticktext"] == ["a · train"]
