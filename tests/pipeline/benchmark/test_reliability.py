"""Calibration measures on statements whose reliability is known."""

import math
from xml.etree import ElementTree

import numpy as np
import pytest

from simgap.benchmark.reliability import (
    brier_score,
    calibration_error,
    calibration_error_by_chance,
    reliability,
    reliability_figure,
)


def test_exact_numbers():
    stated = [(0.9, True), (0.9, True), (0.9, False), (0.2, False)]
    assert brier_score(stated) == pytest.approx((0.01 + 0.01 + 0.81 + 0.04) / 4)
    assert calibration_error(stated) == pytest.approx((3 * abs(0.9 - 2 / 3) + 0.2) / 4)
    low, high = reliability(stated)
    assert (low.stated, low.kept.value, high.kept.total) == (0.2, 0.0, 3)


def test_certainty_belongs_to_the_last_bin():
    (only,) = reliability([(1.0, True), (0.95, True)])
    assert only.kept.total == 2


def test_chance_leaves_less_the_more_statements_there_are():
    """A single bin of n statements at p misses its share by √(2·p·(1 − p)/(π·n)) on average."""
    for count in (50, 800):
        stated = [(0.8, True)] * count
        expected = math.sqrt(2 * 0.8 * 0.2 / (math.pi * count))
        assert calibration_error_by_chance(stated) == pytest.approx(expected, rel=0.1)
    assert math.isnan(calibration_error_by_chance([]))


def test_kept_probabilities_have_no_calibration_error():
    random = np.random.default_rng(0)
    probabilities = random.uniform(size=200_000)
    stated = list(
        zip(probabilities.tolist(), (random.uniform(size=200_000) < probabilities).tolist(), strict=True)
    )
    assert calibration_error(stated) < 0.01
    boasted = [(min(p + 0.3, 1.0), true) for p, true in stated]
    assert calibration_error(boasted) > 0.2


def test_nothing_stated_is_neither_good_nor_bad():
    assert math.isnan(brier_score([]))
    assert math.isnan(calibration_error([]))


def test_the_figure_is_a_picture_with_a_point_per_bin():
    stated = [(0.9, True), (0.9, False), (0.2, False)]
    root = ElementTree.fromstring(reliability_figure(stated))
    points = root.findall("{http://www.w3.org/2000/svg}circle")
    assert len(points) == 2
    higher = [float(point.get("cy")) for point in points]
    assert higher[1] < higher[0]  # half of the sure statements were right, none of the others
