import json
import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from simgap.report.competition import competition_section
from simgap.report.figure import LONGEST_LABEL, band, distances, encode, label, script_json
from simgap.report.fit import fit_section
from simgap.report.inputs import ReportInputs
from simgap.report.laws import laws_section
from simgap.report.section import Drawing
from simgap.report.where import where_section
from tests.pipeline.report.artifacts import HOSTILE, make_branch
from tests.pipeline.report.decode import decode


@given(st.dictionaries(st.text(), st.text() | st.just(HOSTILE)))
def test_no_text_ends_the_script_element_that_holds_it(content):
    written = script_json(content)
    assert not set(written) & set("<>&\u2028\u2029")
    assert json.loads(written) == content


@given(st.lists(st.floats(width=32) | st.none()))
def test_numbers_survive_and_what_is_none_is_a_gap(values):
    read = decode(encode(values))
    finite = [math.nan if value is None or math.isinf(value) else value for value in values]
    np.testing.assert_array_equal(read, np.asarray(finite, dtype="<f4"))


@given(st.text(), st.integers(5, 50))
def test_a_label_is_bounded_and_holds_no_markup(words, longest):
    written = label(words, longest)
    assert "<" not in written
    assert len(written) <= 5 * longest
    assert label("rotor drag") == "rotor drag"
    assert label("x" * 100).endswith("…")
    assert len(label("x" * 100)) == LONGEST_LABEL


def test_an_error_bar_reaches_its_bounds_and_an_unknown_one_is_absent():
    bars = distances([1.0, 2.0], [0.5, None], [1.25, 3.0])
    np.testing.assert_array_equal(decode(bars["array"]), [0.25, 1.0])
    np.testing.assert_array_equal(decode(bars["arrayminus"]), [0.5, math.nan])


def test_a_band_is_a_closed_polygon():
    drawn = band([0.0, 1.0], [2.0, 3.0], [4.0, 5.0], "grey")
    np.testing.assert_array_equal(decode(drawn["x"]), [0, 1, 1, 0])
    np.testing.assert_array_equal(decode(drawn["y"]), [4, 5, 3, 2])


def test_every_figure_is_one_that_plotly_accepts(tmp_path):
    import plotly.graph_objects as go

    inputs, drawing = ReportInputs.of_branch(make_branch(tmp_path)), Drawing()
    figures = where_section(inputs, drawing).content["maps"]
    figures += [step["figure"] for step in competition_section(inputs, drawing).content["steps"]]
    figures += (
        fit_section(inputs, drawing).content["horizons"] + laws_section(inputs, drawing).content["figures"]
    )
    assert len(figures) == 12
    for figure in figures:
        go.Figure(json.loads(figure.json))


def test_the_map_shows_multiples_of_the_noise_floor_and_not_a_floor_of_zero(tmp_path):
    branch = make_branch(tmp_path)
    path = branch / "diagnose" / "evidence" / "regimes.json"
    regimes = json.loads(path.read_text())[:2]
    regimes[1]["noise_floor"] = 0.0
    path.write_text(json.dumps(regimes))
    heat = where_section(ReportInputs.of_branch(branch), Drawing()).content["maps"][0].data[0]
    ratios = decode(heat["z"])
    np.testing.assert_allclose(10 ** ratios[0], np.array(regimes[0]["before"]) / 0.03, rtol=1e-5)
    assert np.isnan(ratios[1]).all()
    assert heat["zmax"] >= ratios[0].max()


def test_the_map_that_tells_most_comes_first(tmp_path):
    maps = where_section(ReportInputs.of_branch(make_branch(tmp_path)), Drawing()).content["maps"]
    assert len(maps) == 5
    assert maps[0].caption == "Error over airspeed"


def test_a_diverging_simulator_is_drawn_on_a_logarithmic_axis(tmp_path):
    branch = make_branch(tmp_path)
    path = branch / "diagnose" / "evidence" / "horizon.json"
    horizons = json.loads(path.read_text())
    horizons[0]["before"][-1] = 1e9
    path.write_text(json.dumps(horizons))
    drawn = fit_section(ReportInputs.of_branch(branch), Drawing()).content["horizons"]
    assert [figure.layout["yaxis"].get("type") for figure in drawn] == ["log", None]
