import json

from simgap.report.driven import driven_section
from simgap.report.inputs import ReportInputs
from simgap.report.page import write_page
from simgap.report.section import Drawing
from tests.pipeline.report.artifacts import HOSTILE

PLANNED = {
    "policy/time": 1.5,
    "policy_in_build_sim/time": 1.6,
    "published_trapezoid/time": None,
    "policy/over_bound": 0.1,
    "training/policy/return": 9.0,
}


def outcome(prefix="", inside=5.0):
    trials = {"number": 5.0, "inside": inside, "mean_miss": 0.0123, "worst_miss": 0.02, "time": 1.9}
    trials |= {"spread_time": 0.05, "spread_miss": None}
    return {f"{prefix}foreseen/time": 1.8} | {f"{prefix}trials/{key}": value for key, value in trials.items()}


def written(folder, **stages):
    for stage, metrics in stages.items():
        (folder / stage).mkdir()
        (folder / stage / "metrics.json").write_text(json.dumps(metrics))
    return ReportInputs.of_branch(folder)


def test_motions_of_every_simulator_stand_beside_their_trials(tmp_path):
    driven = outcome() | outcome("policy_in_build_sim/", inside=3.0)
    section = driven_section(written(tmp_path, profile=PLANNED, deploy=driven), Drawing())
    assert section is not None
    policy, learned, published = section.content["table"].rows
    assert policy[1:5] == ["1.50", "1.80", "1.900\u00a0±\u00a00.050", "5 of 5"]
    assert learned[4:] == ["3 of 5", "0.01230", "0.0200"]
    assert set(published[2:]) == {"–"}


def test_drawings_are_in_the_page_and_no_text_escapes(tmp_path):
    inputs = written(tmp_path, profile=PLANNED | {f"{HOSTILE.replace('/', '')}/time": 1.0}, deploy=outcome())
    (tmp_path / "profile" / "motions.svg").write_text("<svg/>")
    write_page(inputs, tmp_path / "page.html")
    page = (tmp_path / "page.html").read_text()
    assert "data:image/svg+xml;base64,PHN2Zy8+" in page
    assert "<script>window" not in page
    assert '<section id="driven">' in page


def test_where_nothing_was_planned_there_is_no_section(tmp_path):
    assert driven_section(written(tmp_path, profile={}, deploy=outcome()), Drawing()) is None
