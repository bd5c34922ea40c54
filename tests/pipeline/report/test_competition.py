from simgap.report.competition import bounded, competition_section
from simgap.report.inputs import ReportInputs
from simgap.report.page import write_page
from simgap.report.section import Drawing
from simgap.report.text import NARROW_SPACE
from tests.pipeline.report.artifacts import make_branch


def test_every_candidate_stands_in_the_table_with_what_became_of_it(tmp_path):
    section = competition_section(ReportInputs.of_branch(make_branch(tmp_path)), Drawing())
    assert section is not None
    said = {entry["name"]: entry["said"] for entry in section.content["candidates"]}
    assert said == {
        "rotor_drag": "in",
        "blade_flapping_moment": "perhaps",
        "body_drag": "cannot be told",
        "steady_wind": "out",
        "motor_lag": "out",
    }
    assert section.content["candidates"][0]["values"] == ["coefficient 0.4512\u00a0±\u00a00.0083 s⁻¹"]


def test_the_table_stands_first_and_the_steps_are_folded_away(tmp_path):
    write_page(ReportInputs.of_branch(make_branch(tmp_path)), tmp_path / "page.html")
    page = (tmp_path / "page.html").read_text("utf-8")
    section = page[page.index('<section id="competition">') : page.index('<section id="where">')]
    assert section.index(f"added, then dropped: probability of only 4{NARROW_SPACE}%") < section.index(
        "<details>"
    )
    assert (
        section.index("<details>")
        < section.index("Step 1: rotor drag is added")
        < section.index("</details>")
    )


def test_no_share_is_more_than_all_or_less_than_nothing():
    written = [bounded(share).rstrip("\u202f%") for share in (-0.34, 0.0, 0.25, 1.187, None)]
    assert written == ["0", "0", "25", "100", ""]
