import json
import math
import re
from importlib import resources

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simgap.report.figure import band, encode, label, points, script_json
from simgap.report.fit import fit_section
from simgap.report.inputs import ReportInputs
from simgap.report.section import Drawing
from simgap.report.where import where_section
from tests.pipeline.report.artifacts import HOSTILE, make_branch
from tests.pipeline.report.decode import decode


@given(st.dictionaries(st.text(), st.text() | st.just(HOSTILE)))
def test_no_text_ends_the_script_element_that_holds_it(content):
    written = script_json(content)
    assert not set(written) & set("<>&\u2028\u2029")
    assert json.loads(written) == content


@given(st.lists(st.floats(-1e6, 1e6) | st.none()))
def test_numbers_survive_to_a_step_and_what_is_none_is_a_gap(values):
    array = np.array([math.nan if value is None else value for value in values])
    known = array[np.isfinite(array)]
    finer = 1e-5 * np.abs(known).max(initial=0.0) if len(values) <= 40 else np.ptp(known) / 65534
    np.testing.assert_allclose(decode(encode(array)), array, atol=finer + 1e-300)


def test_a_long_series_takes_two_bytes_a_value_and_keeps_its_ends():
    values = np.linspace(-3.0, 7.0, 1000)
    coded = encode(values)
    assert isinstance(coded, dict)
    assert len(coded["u2"]) < 2.7 * len(values)
    read = decode(coded)
    assert (read[0], read[-1]) == (-3.0, pytest.approx(7.0, abs=1e-12))


@given(st.text(), st.integers(5, 50))
def test_a_label_is_bounded_and_in_one_line(words, longest):
    written = label(words, longest)
    assert len(written) <= longest
    assert "\n" not in written


def test_a_label_has_the_minus_sign_of_print():
    assert label("from -3 to 2 of run-1") == "from −3 to 2 of run-1"


def test_error_bars_and_bands_reach_their_bounds():
    drawn = points([0.0, 1.0], [1.0, 2.0], "mean", "grey", ([0.5, None], [1.25, 3.0]))
    np.testing.assert_array_equal(decode(drawn["low"]), [0.5, math.nan])
    np.testing.assert_array_equal(decode(drawn["high"]), [1.25, 3.0])
    area = band([0.0, 1.0], [2.0, 3.0], [4.0, 5.0], "grey")
    assert (area["low"], area["high"]) == ([2.0, 3.0], [4.0, 5.0])


def test_the_map_shows_multiples_of_the_noise_floor_and_not_a_floor_of_zero(tmp_path):
    branch = make_branch(tmp_path)
    path = branch / "diagnose" / "evidence" / "regimes.json"
    regimes = json.loads(path.read_text())[:2]
    regimes[0]["before"][0], regimes[0]["after"][0] = 0.06, 0.01
    regimes[1]["noise_floor"] = 0.0
    path.write_text(json.dumps(regimes))
    (drawn,) = where_section(ReportInputs.of_branch(branch), Drawing()).content["maps"]
    before, after = drawn.rows[0][1].values()
    unknown = drawn.rows[1][1]["before"]
    assert (before[0].text, after[0].text) == ("2", "0.33")
    assert "RMS error 0.0600 m/s², noise floor 0.0300 m/s²" in before[0].said
    assert before[0].depth > after[0].depth == 0
    assert max(cell.depth for cell in before) == 100
    assert {(cell.text, cell.depth) for cell in unknown} == {("–", None)}  # not the colour of a perfect one


def test_bins_have_the_digits_that_tell_them_apart_and_tiny_cells_are_a_bound(tmp_path):
    branch = make_branch(tmp_path)
    path = branch / "diagnose" / "evidence" / "regimes.json"
    (entry, *_) = json.loads(path.read_text())
    entry |= {"edges": [-1.3812, -1.3794, -1.2, 0.0], "noise_floor": 1.0}
    entry |= {"before": [1.8e-13, 2.0, 3.0], "after": [None, 1.0, 1.0]}
    path.write_text(json.dumps([entry]))
    (drawn,) = where_section(ReportInputs.of_branch(branch), Drawing()).content["maps"]
    assert all(low != high for low, high in drawn.bins)
    cells = drawn.rows[0][1]
    assert cells["before"][0].text == "<\u202f0.01"
    assert "unknown" in cells["after"][0].said


def test_a_mismatch_that_is_everywhere_has_no_range(tmp_path):
    branch = make_branch(tmp_path)
    path = branch / "diagnose" / "diagnosis.json"
    found = json.loads(path.read_text())
    found["mismatch"][0]["where"] = "The simulator's error in roll is 2 N·m; sensor noise alone would give 1."
    path.write_text(json.dumps(found))
    assert where_section(ReportInputs.of_branch(branch), Drawing()).content["rows"][0]["regime_range"] == ""


@pytest.mark.parametrize("theme", [0, 1], ids=["light", "dark"])
def test_every_cell_of_a_map_can_be_read(theme):
    """The least contrast of WCAG 2.2 for text, at both ends of the colours."""
    style = resources.files("simgap.report").joinpath("templates", "page.css").read_text("utf-8")
    ink, low, high = (
        re.findall(rf"--{name}: (#[0-9a-f]{{6}})", style)[theme] for name in ("ink", "map-low", "map-high")
    )
    assert min(_contrast(ink, low), _contrast(ink, high)) >= 4.5


def _contrast(one: str, other: str) -> float:
    light, dark = sorted(map(_luminance, (one, other)), reverse=True)
    return (light + 0.05) / (dark + 0.05)


def _luminance(colour: str) -> float:
    parts = (int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5))
    linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
    return float(np.dot(linear, (0.2126, 0.7152, 0.0722)))


def test_horizons_at_which_the_answer_predicts_worse_are_said(tmp_path):
    branch = make_branch(tmp_path)
    inputs = ReportInputs.of_branch(branch)
    assert fit_section(inputs, Drawing()).content["worse"] == []
    path = branch / "diagnose" / "evidence" / "horizon.json"
    horizons = json.loads(path.read_text())
    horizons[0]["after"][-2:] = [2 * value for value in horizons[0]["before"][-2:]]
    path.write_text(json.dumps(horizons))
    (said,) = fit_section(inputs, Drawing()).content["worse"]
    assert said == "position between 0.4 and 0.5 s (2 times at most)"


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
    assert [(figure.log, figure.zero) for figure in drawn] == [(True, False), (False, True)]
