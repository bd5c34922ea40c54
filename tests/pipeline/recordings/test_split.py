"""Runs are divided whole, by patterns or by the seed."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pipeline.errors import InputError
from pipeline.recordings.split import PARTS, Split, require_holdout, runs_of, split_runs

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
