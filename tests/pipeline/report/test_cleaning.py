import pandas as pd

from pipeline.report.cleaning import cleaning_section, summary
from pipeline.report.inputs import ReportInputs
from pipeline.report.section import Drawing
from tests.pipeline.report.artifacts import make_branch
from tests.pipeline.report.decode import decode


def test_the_summary_loses_no_sample(tmp_path):
    changes = pd.read_parquet(make_branch(tmp_path) / "clean" / "changes.parquet")
    rows = summary(changes)
    assert sum(row["samples"] for row in rows) == changes["samples"].sum()
    assert [row["step"] for row in rows] == ["resample", "frozen", "spikes"]
    assert {row["runs"] for row in rows} == {7}


def test_the_timeline_covers_every_run_from_its_own_start(tmp_path):
    content = cleaning_section(ReportInputs.of_branch(make_branch(tmp_path)), Drawing()).content
    assert [trace["name"] for trace in content["figure"].data] == ["kept", "interpolated", "dropped"]
    drawn = sum(decode(trace["x"]).sum() for trace in content["figure"].data)
    assert abs(drawn - 7 * 60.0) < 1e-3
    assert min(decode(trace["base"]).min() for trace in content["figure"].data) == 0.0


def test_details_are_bounded_and_say_so(tmp_path):
    content = cleaning_section(ReportInputs.of_branch(make_branch(tmp_path)), Drawing(detail_rows=5)).content
    assert len(content["details"]) == 5
    assert content["all"] == 21
