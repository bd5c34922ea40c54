"""Shares and quantiles against known numbers."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from simgap.benchmark.intervals import Share, quantile, share_of


@given(total=st.integers(1, 500), data=st.data())
def test_the_interval_is_wilsons(total, data):
    count = data.draw(st.integers(0, total))
    low, high = Share(count, total).interval
    expected = stats.binomtest(count, total).proportion_ci(method="wilson")
    assert low == pytest.approx(expected.low, abs=1e-6)
    assert high == pytest.approx(expected.high, abs=1e-6)


def test_no_cases_tell_nothing():
    assert math.isnan(Share(0, 0).value)
    assert Share(0, 0).interval == (0.0, 1.0)
    assert Share(0, 0).text == "no cases"


def test_a_share_reads_as_percent_interval_and_cases():
    assert share_of([True, True, True, False]).text == "75% (30%–95%, 3 of 4)"


@given(values=st.lists(st.floats(-1e6, 1e6), min_size=1, max_size=30), place=st.floats(0.0, 1.0))
def test_quantiles_are_interpolated_linearly(values, place):
    assert quantile(values, place) == pytest.approx(float(np.quantile(values, place)), rel=1e-9, abs=1e-6)


def test_without_values_there_is_no_quantile():
    assert math.isnan(quantile([], 0.5))
