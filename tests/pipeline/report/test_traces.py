import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simgap.report.inputs import ReportInputs
from simgap.report.section import Drawing
from simgap.report.traces import thin, traces_section
from tests.pipeline.report.decode import decode


@given(st.integers(1, 3000), st.integers(20, 500), st.integers(0, 1000))
def test_thinning_keeps_ends_and_extremes_in_order(count, keep, seed):
    values = np.random.default_rng(seed).normal(size=(count, 3))
    chosen = thin(np.arange(count, dtype=float), values, keep)
    assert (np.diff(chosen) > 0).all()
    assert {0, count - 1} <= set(chosen.tolist())
    assert set(values.argmax(axis=0)) | set(values.argmin(axis=0)) <= set(chosen.tolist())
    assert len(chosen) <= max(keep + 8, 8)


def test_no_line_is_drawn_across_a_gap(tmp_path):
    time = np.concatenate([np.arange(0, 5, 0.01), np.arange(9, 12, 0.01)])
    table = pd.DataFrame({"run": "a", "channel": "force_x", "unit": "m/s²", "t": time + 100.0})
    table = table.assign(measured=np.sin(time), before=np.sin(time), after=np.sin(time))
    (tmp_path / "evidence").mkdir()
    table.to_parquet(tmp_path / "evidence" / "traces.parquet")
    section = traces_section(ReportInputs(diagnose=tmp_path), Drawing(trace_samples=300))
    drawn = section.content["series"][0]
    times, measured = decode(drawn["t"]), decode(drawn["measured"])
    assert times[0] == 0
    assert np.isnan(measured).sum() == 1
    assert times[np.isnan(measured)] == pytest.approx(9.0, abs=1e-3)
    assert len(times) < len(time)


def test_many_traces_do_not_outgrow_the_page(tmp_path):
    runs = [f"run_{number}" for number in range(40)]
    table = pd.concat([pd.DataFrame({"run": run, "t": np.arange(1000) * 0.01}) for run in runs])
    table = table.assign(channel="velocity_x", unit="m/s", measured=1.0, before=0.0, after=0.5)
    (tmp_path / "evidence").mkdir()
    table.to_parquet(tmp_path / "evidence" / "traces.parquet")
    content = traces_section(ReportInputs(diagnose=tmp_path), Drawing(trace_samples=6000)).content
    assert len(content["series"]) == 30
    assert content["left_out"] == 10
    assert sum(len(decode(entry["t"])) for entry in content["series"]) <= 6000 + 30 * 8
