import json
import math

import pytest

from simgap.report.inputs import ReportInputs
from simgap.report.naming import key_in_words
from simgap.report.page import write_page
from simgap.report.section import Drawing
from simgap.report.sure import points, sure_section
from simgap.report.text import NARROW_SPACE
from tests.pipeline.report.artifacts import make_branch
from tests.pipeline.report.diagnoses import UNFINISHED


def content_of(branch):
    section = sure_section(ReportInputs.of_branch(branch), Drawing())
    assert section is not None
    return section.content


def second_of(folder, first, second):
    """Return the second of two explanations in words."""
    branch = make_branch(folder)
    path = branch / "diagnose" / "evidence" / "hypotheses.json"
    known = json.loads(path.read_text())
    path.write_text(json.dumps([known[0] | {"effects": first}, known[1] | {"effects": second}]))
    return content_of(branch)["explanations"][1]["named"]


def section_of(branch, folder):
    write_page(ReportInputs.of_branch(branch), folder / "page.html")
    page = (folder / "page.html").read_text("utf-8")
    return page[page.index('<section id="sure">') : page.index('<section id="where">')]


def test_every_candidate_has_an_answer(tmp_path):
    candidates = content_of(make_branch(tmp_path))["candidates"]
    assert {entry["words"]: entry["answer"] for entry in candidates} == {
        "rotor drag": "in",
        "blade flapping moment": "perhaps",
        "body drag": "cannot be told",
        "rotor fault (rotor 3)": "out",
        "motor lag": "out",
    }
    assert candidates[0]["values"] == ["coefficient 0.4512\u00a0±\u00a00.0083 s⁻¹"]


def test_an_explanation_is_told_in_words(tmp_path):
    best, held, bare = content_of(make_branch(tmp_path))["explanations"]
    assert (best["named"], best["small"]) == ("axial inflow and rotor drag", "command delay")
    assert best["commands"] == "as recorded"
    assert held["commands"] == "held, battery voltage estimated"
    assert held["named"] == "the same"
    assert (bare["named"], bare["small"]) == ("", "")
    assert bare["commands"] == "as recorded, rotor fault (rotor 3) in a part of the recording"


@pytest.mark.parametrize(
    ("effects", "words"),
    [
        (["axial_inflow", "rotor_drag", "steady_wind"], "the same plus steady wind"),
        (["rotor_drag"], "rotor drag"),
        (["axial_inflow", "body_drag"], "axial inflow and body drag"),
        (["body_drag"], "body drag"),
    ],
)
def test_an_explanation_is_told_by_its_difference_from_the_first_where_that_is_shorter(
    tmp_path, effects, words
):
    assert second_of(tmp_path, ["axial_inflow", "rotor_drag"], effects) == words


def test_an_explanation_may_lack_or_replace_effects_of_the_first(tmp_path):
    three = ["axial_inflow", "body_drag", "rotor_drag"]
    assert second_of(tmp_path / "a", three, three[:2]) == "the same without rotor drag"
    swapped = [*three[:2], "steady_wind"]
    assert second_of(tmp_path / "b", three, swapped) == "the same with steady wind in place of rotor drag"


def test_the_parts_of_a_score_are_differences_from_the_first_line_and_add_up(tmp_path):
    best, held, bare = content_of(make_branch(tmp_path))["explanations"]
    assert best["points"] == ["0", "0", "0", "0"]
    assert held["points"] == ["−4.0", "+2.5", "−0.7", "−2.2"]
    assert bare["points"] == ["−151", "+18.0", "+4.0", "−129"]


@pytest.mark.parametrize(
    ("value", "written"), [(7.02, "0"), (6.96, "0"), (8.24, "+1.2"), (-28.0, "−35.0"), (-1e6, "−1.00×10⁶")]
)
def test_a_point_has_a_sign_and_no_digits_without_meaning(value, written):
    assert points(value, 7.0) == written


def test_a_hypothesis_that_cannot_be_is_left_out(tmp_path):
    branch = make_branch(tmp_path)
    path = branch / "diagnose" / "evidence" / "hypotheses.json"
    listed = json.loads(path.read_text())
    impossible = listed[-1] | {"prior": None, "score": None, "probability": 0.0}
    path.write_text(json.dumps([*listed, impossible]))
    assert len(content_of(branch)["explanations"]) == len(listed)


def test_the_candidates_stand_first_and_the_explanations_are_folded_away(tmp_path):
    section = section_of(make_branch(tmp_path), tmp_path)
    order = [
        f"explains 91{NARROW_SPACE}% of the error in force x",
        "<details>",
        "The 3 most probable explanations",
        "axial inflow and rotor drag<br>",
        "All explanations that are not listed have",
        "</details>",
    ]
    places = [section.index(text) for text in order]
    assert places == sorted(places)
    assert "was ended" not in section


def test_the_probability_of_what_is_not_listed_is_what_is_missing_to_one(tmp_path):
    assert math.isclose(content_of(make_branch(tmp_path))["others"], 0.06, abs_tol=1e-9)


def test_a_search_that_was_ended_says_so_beside_what_it_found(tmp_path):
    branch = make_branch(tmp_path)
    path = branch / "diagnose" / "diagnosis.json"
    found = json.loads(path.read_text())
    found["warnings"].append(UNFINISHED)
    path.write_text(json.dumps(found))
    assert "The search was ended before it was complete" in section_of(branch, tmp_path)


@pytest.mark.parametrize(
    ("key", "words"),
    [
        ("coulomb_friction", "Coulomb friction"),
        ("rotor_fault@3", "rotor fault (rotor 3)"),
        ("backlash@steer", "backlash (steer)"),
        ("slope@chassis", "slope"),
        ("module_misalignment@chassis", "module misalignment (module 2)"),
        ("sensor_time_offset", "sensor time offset (state)"),
    ],
)
def test_a_key_is_written_as_words_with_its_subject(key, words):
    subjects = {"module_misalignment": "module 2", "sensor_time_offset": "state", "rotor_fault": "rotor 1"}
    assert key_in_words(key, subjects) == words
