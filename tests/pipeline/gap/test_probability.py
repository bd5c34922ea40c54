"""What a probability is made of."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from simgap.gap.probability import CALIBRATION, DIRECTIONS, Features, presence_of, probability_of

SIGNS = st.builds(
    Features,
    gain=st.floats(0.0, 1e4),
    parameters=st.integers(1, 4),
    clusters=st.integers(2, 500),
    unsteadiness=st.floats(0.0, 10.0),
    signal=st.floats(-1.0, 1e6),
    excess=st.floats(0.1, 1e4),
    weight=st.floats(0.01, 1.0),
)


def test_evidence_is_the_gain_less_the_price_of_parameters():
    assert Features(gain=10.0, parameters=2, clusters=100).log_bayes_factor == pytest.approx(
        10.0 - math.log(100)
    )


@given(SIGNS)
def test_a_probability_is_one_and_never_certain(features):
    assert 0.0 <= probability_of(features) <= presence_of(features) < 1.0


@given(SIGNS, st.floats(1.0, 100.0))
def test_more_evidence_never_lowers_a_probability(features, more):
    richer = Features(**(vars(features) | {"gain": features.gain + more}))
    assert presence_of(richer) >= presence_of(features)


@given(SIGNS, st.floats(0.0, 100.0))
def test_explaining_more_never_lowers_a_probability(features, more):
    richer = Features(**(vars(features) | {"signal": features.signal + more}))
    assert presence_of(richer) >= presence_of(features)


@given(SIGNS, st.floats(0.1, 10.0))
def test_what_is_left_over_or_drifts_never_raises_a_probability(features, more):
    for name in ("unsteadiness", "excess"):
        worse = Features(**(vars(features) | {name: getattr(features, name) + more}))
        assert presence_of(worse) <= presence_of(features)


@given(SIGNS, st.floats(1.0, 1e3))
def test_a_smaller_noise_changes_nothing_where_much_more_than_noise_is_left(features, times):
    """The noise of a real recording is often filtered away: its level then says little."""
    real = Features(**(vars(features) | {"signal": 5.0, "excess": 20.0}))
    finer = Features(**(vars(features) | {"signal": 5.0 * times, "excess": 20.0 * times}))
    assert presence_of(finer) == presence_of(real)


@given(SIGNS)
def test_rivals_share_the_probability(features):
    assert probability_of(features) == pytest.approx(presence_of(features) * features.weight)


def test_strong_evidence_convinces_and_weak_does_not():
    assert presence_of(Features(gain=2000.0, parameters=1, clusters=20)) > 0.8
    assert presence_of(Features(gain=1.0, parameters=1, clusters=20)) < 0.5


@given(SIGNS)
def test_what_other_runs_refute_is_not_believed(features):
    refuted = Features(**(vars(features) | {"refuted": True}))
    assert presence_of(refuted) <= min(presence_of(features), 0.25)


@given(SIGNS)
def test_what_samples_are_too_far_apart_to_tell_is_no_likelier_than_not(features):
    coarse = Features(**(vars(features) | {"coarse": True}))
    assert presence_of(coarse) == min(presence_of(features), 0.5)


def test_what_is_left_counts_less_where_far_more_is_explained():
    """Ten times the noise beside ten thousand, beside a hundred, and beside as much."""
    excess = [
        Features(500.0, 1, 20, signal=signal, excess=10.0).scaled["excess"] for signal in (1e4, 1e2, 10.0)
    ]
    assert excess == pytest.approx([math.log10(1.03), math.log10(4.0), 1.0])


@given(SIGNS)
def test_every_feature_has_a_coefficient(features):
    assert set(features.scaled) == set(DIRECTIONS)
    assert CALIBRATION.exists()
