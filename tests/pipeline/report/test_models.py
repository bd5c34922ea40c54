"""What the page says of learned models."""

import base64
import re

from simgap.comparison.figure import FIGURE, draw
from simgap.report import ReportInputs, write_page
from simgap.report.models import RESIDUALS, model_section, sweeps_section
from simgap.report.section import Drawing
from tests.pipeline.comparison.sweeps import job, sweep
from tests.pipeline.report.artifacts import HOSTILE, make_branch, make_sweep


def test_errors_stand_beside_those_of_persistence(tmp_path):
    section = model_section(ReportInputs.of_branch(make_branch(tmp_path)), Drawing())
    assert section is not None
    errors = section.content["errors"]
    assert errors.columns == ["", "1 step", "sum"]
    assert errors.rows == [["position", "0.00100\u00a0(−75\u202f%)", "unknown"]]
    epochs, steps = section.content["tables"]
    assert epochs.rows == [["epochs", "40"]]
    assert (steps.title, steps.columns) == ("steps", ["", "MSE", "R²", "increment R²"])
    assert steps.rows == [["velocity x", "0.25", "0.9", "–"]]


def test_the_residuals_are_a_picture_of_the_section_where_they_were_drawn(tmp_path):
    branch = make_branch(tmp_path)
    inputs = ReportInputs.of_branch(branch)
    section = model_section(inputs, Drawing())
    assert section is not None
    assert base64.b64decode(section.content["residuals"]) == (branch / "train" / RESIDUALS).read_bytes()
    write_page(inputs, tmp_path / "page.html")
    assert "histograms of the residuals" in (tmp_path / "page.html").read_text("utf-8")
    (branch / "train" / RESIDUALS).unlink()
    section = model_section(inputs, Drawing())
    assert section is not None
    assert section.content["residuals"] is None


def test_models_that_a_sweep_compared_stand_side_by_side(tmp_path):
    branch = make_branch(tmp_path)
    assert sweeps_section(ReportInputs.of_branch(branch), Drawing()) is None
    folder = make_sweep(branch)
    inputs = ReportInputs.of_branch(branch)
    assert folder in inputs.folders
    section = sweeps_section(inputs, Drawing())
    assert section is not None
    (sweep,) = section.content["sweeps"]
    (table,) = sweep["tables"]
    assert (sweep["title"], sweep["failed"]) == ("Two models", ["model=x: no"])
    assert table.columns == ["model", "position/h1"]
    assert [row[0] for row in table.rows] == ["lstm", "tcn", "persistence"]
    assert table.rows[1][1] == "1.50\u00a0±\u00a00.71\u00a0(−50\u202f%)"
    assert table.rows[2][1] == "9.000"


def test_where_only_seeds_were_swept_the_row_has_a_name_and_there_is_no_picture(tmp_path):
    folder = tmp_path / "sweeps" / "train" / "comparison"
    folder.mkdir(parents=True)
    seeds = sweep(job(1.0, 0), job(3.0, 1))
    seeds.write(folder)
    draw(seeds, folder / FIGURE)
    section = sweeps_section(ReportInputs.of_branch(tmp_path), Drawing())
    assert section is not None
    (shown,) = section.content["sweeps"]
    assert shown["tables"][0].rows[0][0] == "as configured"
    assert shown["picture"] is None


def test_the_page_holds_the_picture_and_no_markup_of_others(tmp_path):
    branch = make_branch(tmp_path, text=HOSTILE)
    make_sweep(branch, HOSTILE)
    write_page(ReportInputs.of_branch(branch), tmp_path / "page.html")
    page = (tmp_path / "page.html").read_text("utf-8")
    assert '<section id="sweeps">' in page
    assert re.search(r'src="data:image/svg\+xml;base64,[\w+/=]+"', page)
    assert "<script>window.hacked" not in page
    assert "<img src=x" not in page
