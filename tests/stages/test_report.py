import json

import pytest

from simgap.errors import InputError
from simgap.runner import StageRun
from simgap.stages.report import ReportStage, report
from tests.pipeline.report.artifacts import make_branch
from tests.pipeline.report.diagnoses import VERDICTS


@pytest.fixture
def run(tmp_path) -> StageRun:
    output = tmp_path / "output"
    output.mkdir()
    return StageRun(output)


@pytest.mark.parametrize("bare", [False, True])
@pytest.mark.parametrize("verdict", VERDICTS)
def test_the_stage_writes_the_page_and_the_final_numbers(tmp_path, run, verdict, bare):
    branch = make_branch(tmp_path / "branch", verdict, bare=bare)
    report(ReportStage(name="imagined", artifacts=str(branch)), run)
    found = json.loads((branch / "diagnose" / "diagnosis.json").read_text())
    final = json.loads((run.output / "metrics.json").read_text())
    assert final["verdict"] == verdict
    assert final["gap_closed"] == found["fit"]["gap_closed"]
    assert run.metrics == {
        key: value for key, value in final.items() if key != "verdict" and value is not None
    }
    assert (run.output / "report.html").stat().st_size < 8e6


def test_every_folder_that_was_read_is_an_input(tmp_path, run):
    branch = make_branch(tmp_path / "branch")
    report(ReportStage(artifacts=str(branch)), run)
    assert set(run.inputs) == {str(branch / stage) for stage in ("diagnose", "clean", "sysid", "train")}


def test_a_branch_without_artifacts_is_refused(tmp_path, run):
    with pytest.raises(InputError, match="no artifacts to report"):
        report(ReportStage(artifacts=str(tmp_path / "nowhere")), run)
    assert list(run.output.iterdir()) == []
