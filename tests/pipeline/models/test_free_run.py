from dataclasses import replace
from xml.etree import ElementTree

import pytest
import torch

from simgap.errors import InputError
from simgap.models.free_run import free_run_scores, free_run_traces
from simgap.models.trace_figure import trace_figure
from tests.pipeline.models import learnable


@pytest.fixture(scope="module")
def fitted():
    recorded = learnable.linear_joint()
    train, validation, held = learnable.parts_of(recorded)
    model = learnable.new_model("linear", recorded)
    model.fit(train, validation, learnable.QUICK)
    return model, held


def test_a_perfect_model_is_right_and_correlates_fully(fitted):
    scores = free_run_scores(*fitted, duration=2.0)
    assert set(scores) == {"position", "velocity"}
    for score in scores.values():
        assert score["mse"] < 1e-9
        assert score["correlation"] == pytest.approx(1.0)


def test_recorded_states_after_the_first_window_are_not_looked_at(fitted):
    model, held = fitted
    true, length = held.states[2:297], model.settings.sequence_length
    spoiled = replace(held, states=torch.cat([held.states[:length], 0.0 * held.states[length:]]))
    told = free_run_scores(model, spoiled, duration=5.9)  # the whole run
    assert told["velocity"]["mse"] == pytest.approx(float(true[:, 1].square().mean()))


def test_traces_hold_what_is_scored_and_are_drawn(fitted):
    model, held = fitted
    traces = free_run_traces(model, held, duration=5.9)  # the whole run: the only stretch
    squared = (traces["measured"] - traces["modelled"]).pow(2).groupby(traces["state"]).mean()
    scores = free_run_scores(model, held, duration=5.9)
    assert {name: score["mse"] for name, score in scores.items()} == pytest.approx(squared.to_dict())
    assert traces["t"].min() == pytest.approx(held.time_step)
    figure = ElementTree.fromstring(trace_figure(traces))
    lines = [part for part in figure.iter() if part.tag.endswith("polyline")]
    assert [len(line.get("points").split()) for line in lines] == [len(traces) // 2] * 4
    broken = traces.assign(modelled=float("nan"), state="<b>")
    assert "&lt;b&gt;" in trace_figure(broken)


def test_a_stretch_longer_than_every_run_is_refused(fitted):
    with pytest.raises(InputError, match=r"train\.free_run"):
        free_run_scores(*fitted, duration=100.0)
    with pytest.raises(InputError, match=r"train\.free_run"):
        free_run_scores(*fitted, duration=0.001)


def test_stretches_follow_on_each_other_inside_segments(fitted):
    _, held = fitted
    starts = held.stretches(3, 50)
    assert torch.equal(starts, torch.arange(0, 250, 50) + int(held.bounds[0, 0]))
