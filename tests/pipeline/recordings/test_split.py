"""Runs are divided whole, by patterns, by resemblance or by the seed."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simgap.artifacts import PROJECT_ROOT
from simgap.errors import InputError
from simgap.recordings.split import PARTS, Split, require_holdout, runs_of, split_runs

RUNS = st.lists(st.text(min_size=1, max_size=5), unique=True, max_size=30)


@given(runs=RUNS, seed=st.integers(0, 2**31))
def test_fractions_divide_every_run_once(runs, seed):
    parts = split_runs(runs, Split(), seed)
    assert list(parts) == runs
    assert set(parts.values()) <= set(PARTS)
    if runs:
        assert runs_of(parts, "train")
    assert bool(runs_of(parts, "holdout")) == (len(runs) >= 2)


@given(runs=RUNS, seed=st.integers(0, 2**31))
def test_the_seed_decides_and_the_order_does_not(runs, seed):
    assert split_runs(runs, Split(), seed) == split_runs(list(reversed(runs)), Split(), seed)


def test_a_quarter_is_held_out():
    parts = split_runs([f"run{index}" for index in range(20)], Split(), 3)
    assert [len(runs_of(parts, part)) for part in PARTS] == [12, 3, 5]


@given(points=st.lists(st.floats(-10, 10), min_size=2, max_size=12), seed=st.integers(0, 2**31))
def test_what_is_held_out_resembles_what_is_fitted(points, seed):
    """No choice of one run would have one that is nearer to a run that stays."""
    runs = [f"run{index}" for index in range(len(points))]
    distances = np.abs(np.subtract.outer(points, points))
    parts = split_runs(runs, Split(holdout_fraction=0.01, validation_fraction=0.0), seed, distances)
    (held,) = (runs.index(run) for run in runs_of(parts, "holdout"))
    apart = distances + np.diag([np.inf] * len(points))
    assert apart[held].min() == pytest.approx(apart.min(), abs=1e-6)


def test_a_run_that_is_alone_in_what_it_does_is_fitted():
    points = np.array([0.0, 0.1, 0.2, 0.3, 5.0, 9.0])
    runs = ["a", "b", "c", "d", "alone", "far"]
    distances = np.abs(np.subtract.outer(points, points))
    for seed in range(20):
        parts = split_runs(runs, Split(holdout_fraction=0.4, validation_fraction=0.0), seed, distances)
        assert set(runs_of(parts, "holdout")) <= {"a", "b", "c", "d"}
        assert runs_of(parts, "train")[-2:] == ["alone", "far"]


def test_of_two_that_are_alike_the_one_nearer_to_all_is_held_out():
    points = np.array([0.0, 0.1, 0.5, 1.0])
    parts = split_runs(
        list("abcd"), Split(validation_fraction=0.0), 0, np.abs(np.subtract.outer(points, points))
    )
    assert runs_of(parts, "holdout") == ["b"]


def test_chance_draws_where_it_is_asked_to():
    runs = [f"run{index}" for index in range(9)]
    distances = np.abs(np.subtract.outer(np.arange(9.0), np.arange(9.0)))
    split = Split(held_out_by="chance")
    assert split_runs(runs, split, 1, distances) == split_runs(runs, split, 1)
    with pytest.raises(InputError, match=r"dataset\.split\.held_out_by.*resemblance or chance"):
        split_runs(runs, Split(held_out_by="luck"))


def test_nothing_is_held_out_where_nothing_is_asked():
    assert set(split_runs(["a", "b"], Split(holdout_fraction=0.0, validation_fraction=0.0)).values()) == {
        "train"
    }


def test_patterns():
    split = Split(holdout=["melon_*"], validation=["square_5"])
    parts = split_runs(["square_1", "square_5", "melon_1", "random"], split)
    assert parts == {"square_1": "train", "square_5": "validation", "melon_1": "holdout", "random": "train"}


def test_patterns_that_leave_nothing_to_fit():
    with pytest.raises(InputError, match="no run is left to fit"):
        split_runs(["a", "b"], Split(holdout=["*"]))


def test_a_fraction_that_is_none():
    with pytest.raises(InputError, match="holdout_fraction"):
        split_runs(["a", "b"], Split(holdout_fraction=1.5))


def test_a_proof_needs_a_run_held_out():
    require_holdout({"a": "train", "b": "holdout"})
    with pytest.raises(InputError, match="no run can be held out; record a second run"):
        require_holdout({"a": "train"})
    with pytest.raises(InputError, match=r"name runs in dataset\.split\.holdout"):
        require_holdout({"a": "train", "b": "train"})


def test_six_equally_long_runs_give_an_interval_of_the_closed_gap_as_the_pages_say():
    """An interval needs two held-out runs: see `test_one_held_out_run_gives_no_interval` for the other half."""
    held = {
        count: {
            len(runs_of(split_runs([f"r{run}" for run in range(count)], Split(), seed), "holdout"))
            for seed in range(5)
        }
        for count in range(2, 12)
    }
    assert all(counts == {1} for count, counts in held.items() if count < 6)
    assert all(min(counts) >= 2 for count, counts in held.items() if count >= 6)
    for page in ("README.md", "docs/index.md", "docs/report.md", "docs/data.md"):
        assert "six equally long runs" in (PROJECT_ROOT / page).read_text(encoding="utf-8"), page
