"""What is held out is a share of the seconds, and never half of a test or most of the recording."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simgap.recordings.split import Split, runs_of, split_runs

LENGTHS = st.lists(st.floats(0.5, 200.0), min_size=2, max_size=16)
SHARES = st.floats(0.05, 0.6)
SEEDS = st.integers(0, 2**31)


def named(seconds):
    return {f"run{index}": length for index, length in enumerate(seconds)}


def divided(seconds, pairs=(), seed=0, distances=None, **fractions):
    known = named(seconds)
    return split_runs(list(known), Split(**fractions), seed, distances, known, pairs)


def paired(count, pairs):
    return [(f"run{2 * index}", f"run{2 * index + 1}") for index in range(min(pairs, count // 2))]


def held_seconds(parts, seconds):
    return sum(named(seconds)[run] for run in runs_of(parts, "holdout"))


@given(seconds=LENGTHS, share=SHARES, pairs=st.integers(0, 8), seed=SEEDS)
def test_half_of_the_seconds_is_fitted_and_both_directions_stay_together(seconds, share, pairs, seed):
    pairs = paired(len(seconds), pairs)
    parts = divided(seconds, pairs, seed, holdout_fraction=share)
    fitted = sum(named(seconds)[run] for run in runs_of(parts, "train"))
    assert runs_of(parts, "holdout")
    assert fitted >= sum(seconds) * (0.5 - 1e-6)
    if len(seconds) > 2 or not pairs:
        assert all(parts[one] == parts[other] for one, other in pairs)


@given(seconds=LENGTHS, share=SHARES, pairs=st.integers(0, 8), seed=SEEDS)
def test_about_the_share_is_held_out(seconds, share, pairs, seed):
    """No more is over than was lacking before the last test, unless even the shortest test is more."""
    pairs = paired(len(seconds), pairs)
    parts = divided(seconds, pairs, seed, holdout_fraction=share)
    known, total = named(seconds), sum(seconds)
    tests = [*pairs, *((run,) for run in known if not any(run in pair for pair in pairs))]
    tests = tests if len(tests) > 1 else [(run,) for run in known]
    lengths = [sum(known[run] for run in test) for test in tests]
    held = held_seconds(parts, seconds)
    assert held <= max(2.0 * share * total, min(lengths)) + 0.02 * total + 1e-6


@given(
    count=st.integers(8, 40),
    share=st.floats(0.1, 0.4),
    seed=SEEDS,
    spread=st.floats(0.0, 0.01),
    data=st.data(),
)
def test_runs_of_about_one_length_are_divided_by_their_number(count, share, seed, spread, data):
    seconds = [10.0 * (1.0 + data.draw(st.floats(-spread, spread))) for _ in range(count)]
    parts = divided(seconds, seed=seed, holdout_fraction=share)
    assert len(runs_of(parts, "holdout")) == pytest.approx(share * count, abs=1.0)


@given(seconds=LENGTHS, pairs=st.integers(0, 8), seed=SEEDS, data=st.data())
def test_the_order_of_the_runs_does_not_matter(seconds, pairs, seed, data):
    known, pairs = named(seconds), paired(len(seconds), pairs)
    points = np.arange(len(known)) ** 1.5
    distances = np.abs(np.subtract.outer(points, points))
    order = data.draw(st.permutations(range(len(known))))
    runs = list(known)
    parts = split_runs(runs, Split(), seed, distances, known, pairs)
    again = split_runs(
        [runs[index] for index in order], Split(), seed, distances[np.ix_(order, order)], known, pairs[::-1]
    )
    assert again == parts


@given(seed=SEEDS, alike=st.booleans())
def test_a_long_run_among_short_ones_is_fitted(seed, alike):
    seconds = [100.0, 5.0, 5.0, 5.0, 5.0]
    distances = np.abs(np.subtract.outer([0.0, 0.0, 9.0, 20.0, 40.0], [0.0, 0.0, 9.0, 20.0, 40.0]))
    parts = divided(seconds, seed=seed, distances=distances if alike else None)
    assert parts["run0"] == "train"
    assert len(runs_of(parts, "holdout")) == 2  # half of the tests, though it is 8 % of the seconds


def test_of_two_runs_the_shorter_one_is_held_out():
    assert divided([28.0, 14.0]) == {"run0": "train", "run1": "holdout"}


def test_one_long_run_may_be_a_quarter():
    """Seconds count: one run of 10 s is held out, not three of ten."""
    points = np.array([0.0, 0.1, *range(10, 18)])
    distances = np.abs(np.subtract.outer(points, points))
    parts = divided([10.0, 10.0, *[2.5] * 8], distances=distances, validation_fraction=0.0)
    assert runs_of(parts, "holdout") == ["run0"] or runs_of(parts, "holdout") == ["run1"]


def test_the_two_directions_of_the_only_test_are_divided_after_all():
    parts = divided([10.0, 10.0], [("run0", "run1")])
    assert sorted(parts.values()) == ["holdout", "train"]


def test_a_test_of_two_directions_is_held_out_only_if_each_resembles_another():
    points = np.array([0.0, 50.0, 0.1, 0.2, 0.3, 0.4])
    distances = np.abs(np.subtract.outer(points, points))
    parts = divided([5.0] * 6, [("run0", "run1")], distances=distances, validation_fraction=0.0)
    assert {parts["run0"], parts["run1"]} == {"train"}
