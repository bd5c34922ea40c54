import math
from dataclasses import replace

import pytest

from simgap.comparison.comparison import flat
from simgap.comparison.settings import Results, TableOf
from simgap.comparison.table import Estimate, tables_of
from simgap.runner.compose import compose, typed
from simgap.runner.config import StageConfig
from tests.pipeline.comparison.sweeps import job, lengths, sweep


def test_seeds_are_taken_together_as_mean_and_standard_deviation():
    table = tables_of(lengths())[0]
    assert (table.title, table.keys, table.columns) == (
        "position",
        ["model", "model.sequence_length"],
        ["h1", "h10"],
    )
    first, *_, tcn, persistence = table.rows
    assert first.values == {"model": "lstm", "model.sequence_length": 5}
    assert first.entries["h1"].mean == pytest.approx(2.0)
    assert first.entries["h1"].std == pytest.approx(math.sqrt(2.0))
    assert tcn.entries["h10"].mean == pytest.approx(10.0)
    assert len(table.rows) == 2 * 2 + 1
    assert (persistence.reference, persistence.entries["h1"]) == ("persistence", Estimate(8.0))


def test_one_seed_has_no_standard_deviation():
    (row,) = tables_of(sweep(job(1.0, model="tcn")))[0].rows
    assert row.entries["h1"] == Estimate(1.0, None)


def test_a_table_shows_what_matches_and_its_mean():
    wanted = Results(tables=[TableOf("steps/*/mse", "MSE", mean=True)])
    (table,) = tables_of(replace(lengths(), results=wanted))
    assert (table.title, table.columns) == ("MSE", ["motor_1", "motor_2", "mean"])
    assert table.rows[0].entries["mean"].mean == pytest.approx(1.5)
    assert table.rows[0].entries["mean"].std == pytest.approx(0.0)


def test_the_variance_over_the_columns_stands_before_their_mean():
    wanted = Results(tables=[TableOf("steps/*/mse", "MSE", mean=True, variance=True)])
    (table,) = tables_of(replace(lengths(), results=wanted))
    assert table.columns == ["motor_1", "motor_2", "variance", "mean"]
    motors = [table.rows[0].entries[f"motor_{number}"].mean for number in (1, 2)]
    assert table.rows[0].entries["variance"].mean == pytest.approx((motors[0] - motors[1]) ** 2 / 4)


def test_changes_are_held_against_the_baseline():
    table = tables_of(replace(lengths(), results=Results(baseline={"model": "lstm"})))[0]
    lstm, other_lstm, tcn, _, persistence = table.rows
    assert table.baseline is lstm
    assert [table.change(row, "h1") for row in (lstm, persistence)] == [None, None]
    assert table.change(other_lstm, "h1") == pytest.approx(0.0)
    assert table.change(tcn, "h1") == pytest.approx(-0.5)


def test_a_seed_whose_error_ran_away_makes_the_mean_unknown():
    broken = replace(job(1.0, 1, model="tcn"), metrics={"position/h1": None, "position/h10": 2.0})
    (row,) = tables_of(sweep(job(1.0, model="tcn"), broken))[0].rows
    assert math.isnan(row.entries["h1"].mean)
    assert row.entries["h10"].mean == pytest.approx(6.0)


def test_nested_metrics_are_named_by_their_path():
    nested = {"position": {"h1": {"model": 1.0}}, "samples": 3, "verdict": "none", "ok": True, "r2": None}
    assert flat(nested) == {"position/h1/model": 1.0, "samples": 3, "r2": None}


def test_headings_name_the_unit_of_what_was_swept_and_of_what_was_measured():
    units = {"model.sequence_length": "samples", "position/*": "m"}
    table = tables_of(replace(lengths(), results=Results(units=units)))[0]
    assert table.columns == ["h1 (m)", "h10 (m)"]
    assert table.named == {"model": "model", "model.sequence_length": "model.sequence_length (samples)"}
    assert table.rows[0].entries["h1 (m)"].mean == 2.0
    assert table.rows[-1].entries["h10 (m)"].mean == 80.0  # of the reference


def test_units_of_the_project_reach_the_tables():
    config = typed(StageConfig, compose([]))
    assert config.results.with_unit("trials/worst_miss", "worst_miss") == "worst_miss (m)"
    assert config.results.with_unit("laps_completed", "laps_completed") == "laps_completed"
