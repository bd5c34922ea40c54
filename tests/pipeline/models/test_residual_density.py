"""Histogram and density of residuals whose distribution is known, and their figure."""

import xml.etree.ElementTree as ET

import numpy as np
import pytest
from scipy.stats import norm

from simgap.models.residual_density import ResidualDensity
from simgap.models.residual_figure import residual_figure

_SVG = "{http://www.w3.org/2000/svg}"


def normal(samples=20_000, mean=0.3, std=0.2, seed=0):
    return np.random.default_rng(seed).normal(mean, std, samples)


def test_the_density_of_normal_residuals_is_theirs_and_integrates_to_one():
    """Kernels as wide as Scott's rule says widen the normal distribution of the quantiles by as much."""
    found = ResidualDensity.of(norm.ppf((np.arange(5000) + 0.5) / 5000, 0.3, 0.2))
    assert (found.samples, found.mean, found.std) == (5000, pytest.approx(0.3), pytest.approx(0.2, rel=1e-3))
    assert np.trapezoid(found.density, found.grid) == pytest.approx(1.0, abs=1e-3)
    assert found.heights @ np.diff(found.edges) == pytest.approx(1.0 - found.outside / found.samples)
    widened = 0.2 * np.hypot(1.0, 5000**-0.2)
    peak = norm.pdf(0.0, scale=0.2)
    assert found.density == pytest.approx(norm.pdf(found.grid, 0.3, widened), abs=5e-3 * peak)
    shares = np.diff(norm.cdf(found.edges, 0.3, 0.2))
    assert found.heights * np.diff(found.edges) == pytest.approx(shares, abs=1.1 / 5000)


def test_few_great_residuals_are_counted_and_change_neither_range_nor_density():
    plain = ResidualDensity.of(normal())
    great = ResidualDensity.of(np.concatenate([normal(), [1e6, -1e6, np.nan, np.inf]]))
    assert great.outside - plain.outside in range(4, 8)  # the ends move by an order statistic
    assert great.grid[[0, -1]] == pytest.approx(plain.grid[[0, -1]], rel=0.05)
    at = np.interp(plain.grid, great.grid, great.density)
    assert at == pytest.approx(plain.density, abs=0.03 * plain.density.max())


def test_what_was_before_a_correction_has_its_density_on_the_same_grid():
    found = ResidualDensity.of(normal(mean=0.0), normal(mean=1.0, std=0.1))
    assert found.grid[found.density.argmax()] == pytest.approx(0.0, abs=0.1)
    assert found.grid[found.uncorrected.argmax()] == pytest.approx(1.0, abs=0.1)
    assert np.trapezoid(found.uncorrected, found.grid) == pytest.approx(1.0, abs=5e-3)
    assert len(ResidualDensity.of(normal()).uncorrected) == 0


@pytest.mark.parametrize("value", [0.0, -3.0, 1e8])
def test_residuals_that_are_all_alike_are_one_bar_without_a_density(value):
    found = ResidualDensity.of(np.full(5, value))
    assert np.count_nonzero(found.heights) == 1
    assert found.heights.max() * np.diff(found.edges)[0] == pytest.approx(1.0, rel=1e-5)
    assert len(found.density) == 0


def test_residuals_that_differ_by_rounding_alone_are_all_in_the_middle():
    found = ResidualDensity.of(-3.0 * (1.0 + 1e-16 * np.arange(5)))
    middle = np.flatnonzero(found.heights)
    assert set(middle) <= {29, 30}
    assert found.outside == 0


def test_where_no_residual_is_finite_nothing_is_known():
    assert ResidualDensity.of(np.full(3, np.nan)) is None
    assert ResidualDensity.of(np.zeros(0)) is None
    assert "a: no residual is finite" in residual_figure({"a": np.full(3, np.nan)}, {}, {})


def test_the_figure_has_a_panel_for_each_output_and_escapes_their_names():
    residuals = {"<b>&": normal(500), "still": np.zeros(500), "third": normal(500, seed=1)}
    text = residual_figure(residuals, {"<b>&": normal(500, mean=0.5)}, {"<b>&": "<i>"})
    root = ET.fromstring(text)
    words = [element.text for element in root.iter(f"{_SVG}text")]
    mean, std = residuals["<b>&"].mean(), residuals["<b>&"].std()
    assert any(word.startswith(f"<b>& (<i>): {mean:.2g} ± {std:.2g}, ") for word in words)
    assert {"histogram", "density", "uncorrected"} <= set(words)
    assert len(list(root.iter(f"{_SVG}polygon"))) == 3
    curves = [line for line in root.iter(f"{_SVG}polyline") if line.get("fill") == "none"]
    assert len(curves) == 3  # two of the first, none of what does not vary, one of the third
    places = [tuple(map(float, pair.split(","))) for line in curves for pair in line.get("points").split()]
    assert all(0 <= x <= int(root.get("width")) and 0 <= y <= int(root.get("height")) for x, y in places)
    assert text == residual_figure(residuals, {"<b>&": normal(500, mean=0.5)}, {"<b>&": "<i>"})
    assert "uncorrected" not in residual_figure({"a": normal(500)}, {}, {})
