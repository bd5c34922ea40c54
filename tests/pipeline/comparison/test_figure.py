from dataclasses import replace

import pytest

from simgap.comparison.figure import draw
from simgap.comparison.settings import Results, TableOf
from tests.pipeline.comparison.sweeps import job, lengths, sweep


def drawn(comparison, path):
    assert draw(comparison, path / "figure.svg")
    return (path / "figure.svg").read_text()


def test_a_number_that_was_swept_is_the_abscissa_and_the_rest_are_curves(tmp_path):
    text = drawn(lengths(), tmp_path)
    for word in ("model.sequence_length", ">lstm<", ">tcn<", ">persistence<", "position, h10"):
        assert word in text
    assert text.count('id="FillBetweenPolyCollection_') == 2


def test_axes_name_their_units(tmp_path):
    units = {"model.sequence_length": "samples", "position/*": "m"}
    text = drawn(replace(lengths(), results=Results(units=units)), tmp_path)
    assert ">model.sequence_length (samples)<" in text
    assert ">position, h10 (m)<" in text


def test_numbers_beside_the_abscissa_are_named_by_their_key(tmp_path):
    jobs = [job(1.0, model__delay=delay, model__width=width) for delay in (1, 2) for width in (3, 4)]
    text = drawn(sweep(*jobs), tmp_path)
    assert ">model.delay<" in text
    assert ">width 3<" in text
    assert ">width 4<" in text


def test_without_numbers_there_are_bars(tmp_path):
    comparison = sweep(job(1.0, model="lstm"), job(2.0, model="tcn"))
    text = drawn(
        replace(comparison, results=Results(figure=TableOf("steps/*/mse", "MSE", mean=True))), tmp_path
    )
    assert ">lstm<" in text
    assert ">MSE, mean<" in text
    assert "FillBetween" not in text


def test_gaps_are_drawn_too(tmp_path):
    drawn(sweep(job(float("nan"), length=5), job(1.0, length=6)), tmp_path)


def test_the_same_comparison_gives_the_same_bytes(tmp_path):
    first = drawn(lengths(), tmp_path)
    assert drawn(lengths(), tmp_path) == first


@pytest.mark.parametrize("jobs", [[], [job(1.0)], [job(1.0, 0), job(2.0, 1)]])
def test_where_there_is_nothing_to_hold_against_another_nothing_is_drawn(tmp_path, jobs):
    comparison = sweep(*jobs, references={"persistence": {"position/h1": 8.0, "position/h10": 80.0}})
    assert not draw(comparison, tmp_path / "figure.svg")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("spread", "logarithmic"), [(0.001, True), (0.02, False)])
def test_an_axis_is_logarithmic_where_values_are_far_apart_and_no_spread_reaches_zero(
    tmp_path, spread, logarithmic
):
    means = {"a": 1.0, "b": 0.01}
    jobs = [
        job(mean + side * spread, side, model=name) for name, mean in means.items() for side in (0, 1, -1)
    ]
    assert ("mathdefault" in drawn(sweep(*jobs), tmp_path)) == logarithmic
