"""What is believed after a search, from hypotheses with made-up scores."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from simgap.gap.hypothesis import Hypothesis
from simgap.gap.posterior import posterior_of


class Scored(Hypothesis):
    """A hypothesis of which only names and score are known."""

    def __init__(self, score: float, *names: str) -> None:
        object.__setattr__(self, "known", (score, frozenset(names)))

    @property
    def names(self) -> frozenset[str]:
        return self.known[1]

    @property
    def score(self) -> float:
        return self.known[0]


def by_odds(odds: dict[str, float]):
    """Return the posterior of sets, each a text with an effect a letter, of these odds."""
    return posterior_of([Scored(math.log(weight), *names) for names, weight in odds.items()])


scores = st.lists(st.floats(-1e4, 1e4), min_size=1, max_size=30)


@given(scores)
def test_weights_sum_to_one_and_fall_with_the_score(values):
    found = posterior_of([Scored(value, str(index)) for index, value in enumerate(values)])
    assert sum(found.weights) == pytest.approx(1.0)
    assert list(found.weights) == sorted(found.weights, reverse=True)
    assert found.best.score == max(values)
    assert all(0.0 <= p <= 1.0 + 1e-9 for p in found.inclusion().values())


@given(scores, st.floats(-1e3, 1e3))
def test_a_constant_that_all_share_says_nothing(values, constant):
    plain, moved = (
        posterior_of([Scored(value + shift, str(i)) for i, value in enumerate(values)]).inclusion()
        for shift in (0.0, constant)
    )
    assert moved == pytest.approx(plain, rel=1e-6, abs=1e-12)


def test_a_hypothesis_that_is_impossible_has_no_weight():
    found = posterior_of([Scored(-math.inf, "a"), Scored(0.0)])
    assert found.inclusion() == {"a": 0.0}
    assert found.best.names == frozenset()


def test_inclusion_is_the_sum_over_hypotheses():
    found = by_odds({"": 1.0, "a": 2.0, "ab": 4.0, "b": 1.0}).inclusion()
    assert found == pytest.approx({"a": 6 / 8, "b": 5 / 8})
    assert list(found) == ["a", "b"]


def test_names_that_exclude_each_other_are_rivals():
    found = by_odds({"a": 6.0, "b": 4.0, "ab": 0.05})
    assert found.rivals() == [("a", "b")]
    assert found.together("a", "b") == pytest.approx(0.05 / 10.05)
    assert found.best_with("b").names == {"b"}


def test_names_that_are_independent_are_no_rivals():
    assert by_odds({"": 1.0, "a": 1.0, "b": 1.0, "ab": 1.0}).rivals() == []
    assert by_odds({"": 0.16, "a": 0.64, "b": 0.04, "ab": 0.16}).rivals() == []


def test_names_that_come_together_are_no_rivals():
    assert by_odds({"": 4.0, "ab": 6.0}).rivals() == []


def test_a_name_that_is_sure_or_hardly_possible_has_no_rival():
    assert by_odds({"a": 99.0, "b": 1.0}).rivals() == []


def test_three_that_share_one_place_are_rivals_by_pairs():
    assert set(by_odds({"a": 4.0, "b": 3.0, "c": 3.0}).rivals()) == {("a", "b"), ("a", "c"), ("b", "c")}


def test_rivals_are_said_beside_a_name_that_is_sure():
    assert by_odds({"ax": 6.0, "bx": 4.0}).rivals() == [("a", "b")]
