import pandas as pd

from simgap.report.cleaning import cleaning_section, condensed, summary
from simgap.report.inputs import ReportInputs
from simgap.report.section import Drawing
from tests.pipeline.report.artifacts import make_branch


def test_the_summary_counts_the_column_most_concerned_once_per_run():
    rows = [("a", "motor_speed_1", 5), ("a", "motor_speed_2", 7), ("b", "motor_speed_2", 2)]
    changes = pd.DataFrame(
        [
            {"run": run, "step": "fill", "column": column, "reason": "gap", "samples": n, "seconds": n / 100}
            for run, column, n in rows
        ]
        + [{"run": "a", "step": "idle", "column": "", "reason": "still", "samples": -40, "seconds": 0.4}]
    )
    fill, idle = summary(changes)
    assert (fill["samples"], fill["runs"], fill["columns"]) == (9, 2, "motor_speed_{1,2}")
    assert abs(fill["seconds"] - 0.09) < 1e-12
    assert (idle["samples"], idle["runs"], idle["columns"]) == (-40, 1, "")


def test_the_summary_keeps_the_order_of_the_steps(tmp_path):
    rows = summary(pd.read_parquet(make_branch(tmp_path) / "clean" / "changes.parquet"))
    assert [row["step"] for row in rows] == ["resample", "frozen", "spikes"]
    assert {row["runs"] for row in rows} == {7}


def test_columns_are_written_as_the_contract_does():
    assert condensed(["position_x", "position_y", "battery_voltage", "position_x", "body_rate"]) == (
        "position_{x,y}, battery_voltage, body_rate"
    )
    assert condensed(["motor_speed_3"]) == "motor_speed_3"
    assert condensed([""]) == ""


def test_the_timeline_covers_every_run_from_its_own_start(tmp_path):
    drawn = cleaning_section(ReportInputs.of_branch(make_branch(tmp_path)), Drawing()).content["figure"]
    assert [state for state, _ in drawn.legend] == ["kept", "interpolated", "dropped"]
    assert len(drawn.rows) == 7
    for _, _, stretches in drawn.rows:
        assert stretches[0]["x"] == 0.0
        assert abs(sum(stretch["width"] for stretch in stretches) - 1000) < 0.1


def test_details_are_bounded_and_say_so(tmp_path):
    content = cleaning_section(ReportInputs.of_branch(make_branch(tmp_path)), Drawing(detail_rows=5)).content
    assert len(content["details"]) == 5
    assert content["all"] == 21
