"""What a benchmark measures, on hand-made results whose figures are known."""

import math
from pathlib import Path

import pytest

from simgap.benchmark import measures
from simgap.benchmark import page as page_module
from simgap.benchmark.intervals import Share
from simgap.benchmark.page import DOCS, RESULTS, renew_introduction, results_text, write_docs


def result(category="clear", outcome="right", names=("drag",), kind="joint", **score):
    """A result as `simgap prove` writes it; what is not given is that of a perfect diagnosis."""
    concealed = list(names) if category not in ("nothing", "outside") else []
    perfect = {
        "concealed": concealed,
        "named": [[name, 0.9] for name in concealed],
        "outcome": outcome,
        "found": 1.0 if concealed else None,
        "stated": [[0.9, True] for _ in concealed],
        "errors": {name: {"coefficient": 0.04} for name in concealed},
        "gap_closed": 0.95,
        "verdict": "missing_physics",
        "verdict_right": True,
        "unnamed": 0,
    }
    subject = {"category": category, "names": list(names), "strength": category, "condition": 0}
    return {
        "name": "x",
        "case": {"kind": kind, "subject": subject},
        "seconds": 20.0,
        "score": perfect | score,
    }


def failed(category="clear"):
    subject = {"category": category, "names": ["drag"], "strength": category, "condition": 0}
    return {"name": "y", "case": {"kind": "joint", "subject": subject}, "failed": "ValueError: no"}


def measured(name, results):
    return next(bar for bar in measures.BARS if bar.name.startswith(name)).measured(results)


def test_a_case_that_fails_counts_as_wrong():
    assert measured("clear effects", [result(), failed()]) == Share(1, 2)


def test_each_strength_is_counted_by_itself():
    results = [result(), result("faint", "wrong"), result("faint"), result("decoy", "wrong")]
    assert measured("clear effects", results) == Share(1, 1)
    assert measured("faint effects", results) == Share(1, 2)


def test_recall_counts_effects_not_cases():
    results = [result("pair", names=("drag", "lag"), found=0.5), result("pair", names=("drag", "lag"))]
    assert measured("effects of pairs", results) == Share(3, 4)


def test_false_alarms_are_named_nulls():
    results = [result("nothing", "wrong", ()), *(result("nothing", names=()) for _ in range(3))]
    assert measured("nulls", results) == Share(1, 4)


def test_the_error_of_an_effect_is_that_of_its_strength():
    odd = result(errors={"drag": {"coefficient": 0.2, "length": 9.0}})
    assert measured("parameter error", [result(), odd, result(errors={"drag": {}})]) == pytest.approx(0.12)


def test_the_gap_counts_only_where_something_is_concealed():
    results = [result(gap_closed=0.5), result("nothing", names=(), gap_closed=0.0), result(gap_closed=None)]
    assert measured("gap closed", results) == 0.5


def test_the_greatest_wrong_probability_is_that_of_cases_outside():
    outside = result("outside", "wrong", stated=[[0.7, False], [0.9, True]])
    assert measured("greatest probability", [outside, result(stated=[[0.99, False]])]) == 0.7
    assert measured("greatest probability", [result("outside", stated=[])]) == 0.0


def test_false_names_are_those_that_are_believed_and_wrong():
    wrong = result(stated=[[0.5, False], [0.9, False], [0.49, False], [0.9, True]])
    assert measured("false names", [wrong, result(), failed()]) == 1.0
    assert math.isnan(measured("false names", [failed()]))


def test_an_ambiguous_recording_is_right_where_the_right_name_is_listed():
    outcomes = ("right", "ambiguous", "wrong", "unnamed")
    assert measured("ambiguous", [result("ambiguous", outcome) for outcome in outcomes]) == Share(2, 4)


def test_a_published_recording_counts_where_all_that_is_known_is_found_and_what_can_be_is_explained():
    whole = {"score": {"missed": [], "undecided": {}, "explained_enough": True}}
    parts = (
        {"score": {"missed": ["lag"], "undecided": {}, "explained_enough": True}},
        {"score": {"missed": [], "undecided": {"drag": []}, "explained_enough": False}},
    )
    found, is_explained = measures.PUBLISHED_BARS
    assert found.measured([whole, *parts]) == Share(1, 3)
    assert is_explained.measured([whole, *parts]) == Share(2, 3)


@pytest.mark.parametrize(
    ("value", "met"),
    [(0.97, True), (Share(97, 100), True), (0.96, False), (math.nan, None), (Share(0, 0), None)],
)
def test_a_bar_is_met_from_its_figure_on(value, met):
    assert measures.is_met(measures.BARS[0], value) is met


def test_confusions_say_what_was_taken_for_what():
    wrong = result(outcome="wrong", named=[["lag", 0.9]])
    results = [wrong, wrong, result(outcome="unnamed", named=[]), result(), failed()]
    assert measures.confusions(results) == [
        ("drag (clear)", "lag", 2),
        ("drag (clear)", "unnamed", 1),
        ("drag (clear)", "failed", 1),
    ]


def test_the_page_holds_every_bar_against_what_was_measured():
    text = results_text(
        [result(), result("faint", "wrong", named=[["lag", 0.8]]), failed()], "make prove SEED=7"
    )
    assert "`make prove SEED=7`" in text
    assert "| clear effects named first: 50% (9%–91%, 1 of 2) | ≥ 97% | **not met** |" in text
    assert "| faint effects named first: 0% (0%–79%, 0 of 1) | ≥ 85% | **not met** |" in text
    assert "| effects of pairs found: no cases | ≥ 90% | no cases | no cases |" in text
    assert "| joint | `drag` | 1/2 | 0/1 | 4.0% | 95.0% |" in text
    assert "| drag (faint) | lag | 1 |" in text


def test_the_documentation_is_the_page_with_its_figure(tmp_path, monkeypatch):
    monkeypatch.setattr("simgap.benchmark.page.DOCS", tmp_path)
    (tmp_path / "images").mkdir()
    write_docs([result()], "make prove")
    assert (tmp_path / "images" / "reliability.svg").read_text().startswith("<svg")
    assert "images/reliability.svg" in (tmp_path / "proof.md").read_text()


def test_a_new_introduction_leaves_the_results_as_they_were_measured(tmp_path, monkeypatch):
    monkeypatch.setattr("simgap.benchmark.page.DOCS", tmp_path)
    (tmp_path / "images").mkdir()
    write_docs([result()], "make prove")
    page = (tmp_path / "proof.md").read_text()
    (tmp_path / "proof.md").write_text(f"An old introduction.\n\n{page[page.index(RESULTS) :]}")
    renew_introduction()
    assert (tmp_path / "proof.md").read_text() == page


def test_a_page_without_results_is_not_overwritten(tmp_path, monkeypatch):
    monkeypatch.setattr("simgap.benchmark.page.DOCS", tmp_path)
    (tmp_path / "proof.md").write_text("Something else.")
    with pytest.raises(ValueError, match="no heading"):
        renew_introduction()
    assert (tmp_path / "proof.md").read_text() == "Something else."


def test_the_documentation_has_the_introduction_of_today():
    page = (DOCS / "proof.md").read_text(encoding="utf-8")
    introduction = Path(page_module.__file__).with_name("introduction.md").read_text(encoding="utf-8")
    assert page.startswith(f"{introduction}\n{RESULTS}\n"), "run python -m simgap.benchmark.page"
