import numpy as np
import pandas as pd
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from simgap.errors import InputError
from simgap.models.examples import Examples
from simgap.models.layouts import layout_of
from simgap.models.segments import segments
from simgap.models.windows import gather, series_of
from tests.pipeline.models.synthetic import recording

LENGTHS = st.lists(st.tuples(st.integers(0, 2), st.integers(2, 12)), min_size=1, max_size=6)


def frame_of(pieces):
    """Return runs made of segments; `position` holds 100 times the segment's number plus the sample."""
    rows, clock = [], {}
    for number, (run, samples) in enumerate(sorted(pieces)):
        start = clock.get(run, 0.0)
        time = start + 0.01 * np.arange(samples)
        clock[run] = time[-1] + 1.0
        place = 100.0 * number + np.arange(samples)
        rows.append(
            pd.DataFrame(
                {
                    "run": f"r{run}",
                    "t": time,
                    "segment": number,
                    "position": place,
                    "velocity": 0.0,
                    "voltage": place,
                }
            )
        )
    return pd.concat(rows, ignore_index=True)


@given(LENGTHS, st.integers(1, 8))
@settings(max_examples=40, deadline=None)
def test_windows_cross_neither_runs_nor_segments(pieces, length):
    recorded = recording(frame_of(pieces), "joint", sliding=True)
    series = series_of(recorded, layout_of(recorded), recorded.runs)
    starts = series.starts(length)
    assert len(starts) == sum(max(samples - length + 1, 0) for _, samples in pieces)
    places = gather(series.states, starts, length)[..., 0]
    assert torch.equal(places - places[:, :1], torch.arange(length, dtype=torch.float64).expand_as(places))


@given(LENGTHS, st.integers(1, 5))
@settings(max_examples=40, deadline=None)
def test_targets_are_increments_within_a_segment(pieces, length):
    frame = frame_of(pieces)
    frame["velocity"] = frame["position"]
    recorded = recording(frame, "joint", sliding=True)
    layout = layout_of(recorded)
    series = series_of(recorded, layout, recorded.runs)
    if not len(series.starts(length + 1)):
        return
    examples = Examples.of_series(series, layout, length, "training")
    _, targets = examples.take(torch.arange(len(examples)))
    assert torch.all(targets == 1.0)


def test_only_the_named_runs_are_taken():
    recorded = recording(frame_of([(0, 5), (1, 6), (2, 7)]), "joint", sliding=True)
    assert len(series_of(recorded, layout_of(recorded), ["r1"])) == 6
    assert len(series_of(recorded, layout_of(recorded), [])) == 0


def test_a_split_tail_shares_no_sample_with_the_rest():
    recorded = recording(frame_of([(0, 10), (1, 20)]), "joint", sliding=True)
    series = series_of(recorded, layout_of(recorded), recorded.runs)
    before, after = series.split_tail(0.2)
    assert before.bounds.tolist() == [[0, 8], [10, 26]]
    assert after.bounds.tolist() == [[8, 10], [26, 30]]


def test_motors_are_moved_onto_the_clock_of_the_state():
    time = np.arange(0.0, 2.0, 0.01)
    names = [f"{s}_{a}" for s in ("position", "velocity", "body_rate") for a in "xyz"]
    names += [f"attitude_{a}" for a in "wxyz"]
    motors = {f"motor_speed_{number}": 100.0 + 10.0 * time for number in range(1, 5)}
    frame = pd.DataFrame({"run": "a", "t": time, "segment": 0} | dict.fromkeys(names, 0.0) | motors)
    recorded = recording(frame, "quadrotor")
    recorded.clock_offset["a"] = 0.025
    (segment,) = segments(recorded)
    np.testing.assert_allclose(segment.frame["motor_speed_1"], 100.0 + 10.0 * (segment.frame["t"] - 0.025))
    assert len(segment.frame) == len(time) - 3


@given(LENGTHS, st.sampled_from([1, 2, 4, 8]), st.integers(0, 7))
@settings(max_examples=20, deadline=None)
def test_excerpts_that_follow_on_each_other_are_the_whole(pieces, parts, which):
    recorded = recording(frame_of(pieces), "joint", sliding=True)
    series = series_of(recorded, layout_of(recorded), recorded.runs)
    cuts = [series.excerpt(1.0 / parts, part / parts) for part in range(parts)]
    samples = [sample for cut in cuts for first, last in cut.bounds.tolist() for sample in range(first, last)]
    assert samples == list(range(len(series)))
    cut = cuts[which % parts]
    lengths = cut.bounds[:, 1] - cut.bounds[:, 0]
    assert (lengths > 0).all()
    assert abs(int(lengths.sum()) - len(series) / parts) <= 1.0


@pytest.mark.parametrize(("share", "shift"), [(0.0, 0.0), (1.1, 0.0), (0.5, 0.6), (0.5, -0.1)])
def test_an_excerpt_that_does_not_fit_is_refused(share, shift):
    recorded = recording(frame_of([(0, 10)]), "joint", sliding=True)
    series = series_of(recorded, layout_of(recorded), recorded.runs)
    with pytest.raises(InputError, match=r"train\.share"):
        series.excerpt(share, shift)


@pytest.mark.parametrize("most", [1, 7, 1000, None])
def test_windows_to_stop_by_are_some_of_all_from_the_first_to_the_last(most):
    examples = Examples(torch.zeros(60, 1), torch.zeros(60, 1), torch.arange(50), 10)
    kept = examples.at_most(most).starts.tolist()
    assert len(kept) == min(most or 50, 50)
    assert sorted(set(kept)) == kept
    assert kept[0] == 0
    assert kept[-1] == (0 if most == 1 else 49)


def test_no_window_to_stop_by_is_refused():
    examples = Examples(torch.zeros(60, 1), torch.zeros(60, 1), torch.arange(50), 10)
    with pytest.raises(InputError, match="needs at least one"):
        examples.at_most(0)
