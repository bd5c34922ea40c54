import html
from typing import Any

import numpy as np
import pytest

from simgap.api.simulators import build_simulator
from simgap.report.inputs import ReportInputs
from simgap.report.page import write_page
from simgap.report.use import next_recordings
from simgap.simulation.storage import write_simulator
from tests.pipeline.platforms.machines import MACHINES
from tests.pipeline.report.artifacts import make_branch
from tests.pipeline.report.diagnoses import DOUBTED, diagnosis


def advice(found, kind="quadrotor"):
    return list(next_recordings(found, kind))


def test_the_page_ends_with_the_simulator_and_how_to_use_it(tmp_path):
    branch = make_branch(tmp_path)
    write_page(ReportInputs.of_branch(branch, simulator="answer/simulator"), tmp_path / "page.html")
    page = (tmp_path / "page.html").read_text("utf-8")
    last = page[page.index('<section id="use">') :]
    assert "<code>answer/simulator</code>" in last
    assert "<section" not in last[1:]


@pytest.mark.parametrize("kind", MACHINES)
def test_the_program_on_the_page_runs_as_it_stands(tmp_path, kind):
    folder = tmp_path / 'out -1 "<b>" 1e-05'
    write_simulator(build_simulator(MACHINES[kind]).simulator, folder)
    write_page(ReportInputs.of_branch(make_branch(tmp_path), simulator=str(folder)), tmp_path / "page.html")
    page = (tmp_path / "page.html").read_text("utf-8")
    program = html.unescape(page.partition("<pre><code>")[2].partition("</code></pre>")[0])
    made: dict[str, Any] = {}
    exec(program, made)
    assert made["machine"].kind == kind
    assert made["states"].shape == (201, len(made["machine"].state_names))
    assert np.isfinite(made["states"]).all()


def test_after_a_contradiction_the_simulator_is_said_to_be_the_unchanged_one(tmp_path):
    for verdict in ("contradiction", "missing_physics"):
        branch = make_branch(tmp_path / verdict, verdict)
        write_page(ReportInputs.of_branch(branch), tmp_path / "page.html")
        last = (tmp_path / "page.html").read_text("utf-8").partition('<section id="use">')[2]
        assert ("unchanged" in last) == (verdict == "contradiction")


def test_what_cannot_be_told_apart_is_what_to_record():
    (first, *_) = advice(diagnosis("missing_physics"))
    assert first.startswith("To tell body drag and steady wind apart: fly the same line in both directions")


def test_a_doubted_effect_is_shown_by_the_manoeuvre_of_the_catalogue():
    found = diagnosis("none")
    found["effects"] = [DOUBTED]
    assert any(each.startswith("To decide about blade flapping moment: ") for each in advice(found))
    assert not any("blade flapping" in each for each in advice(found, "unheard-of"))


def test_one_run_asks_for_more_runs_and_a_contradiction_for_its_remedy():
    assert advice(diagnosis("none", bare=True))[0].startswith(
        "Record at least two runs, and each sort of motion twice"
    )
    assert advice(diagnosis("contradiction"))[0].startswith("Compare the sign of 'voltage'")


def test_a_warning_that_asks_for_a_recording_is_repeated_and_others_are_not():
    found = diagnosis("none")
    found["warnings"] = [
        "only 3 s could be fitted; record ten seconds",
        "the recording has a gap",
        "record_1 is late",
    ]
    assert advice(found) == ["only 3 s could be fitted; record ten seconds"]


def test_what_lies_within_the_noise_asks_for_nothing():
    found = diagnosis("unexplained")
    (said,) = advice(found)
    assert said.startswith(
        "To learn what acts on torque y: vary velocity x and motor speed over a wide range"
    )
    found["unnamed"][0]["size"]["noise"] = 1.0
    assert advice(found) == []
