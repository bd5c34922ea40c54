import json

import numpy as np
import pandas as pd
from PIL import Image

from simgap.report.flown import flown_section
from simgap.report.inputs import ReportInputs
from simgap.report.page import write_page
from simgap.report.race import animate_race
from simgap.report.section import Drawing

GATE = np.array([[[1.0, -0.5, 0.5], [1.0, 0.5, 0.5], [1.0, 0.5, 1.5], [1.0, -0.5, 1.5]]], dtype=np.float32)


def flight(seconds):
    time = np.arange(0.0, seconds, 0.02)
    turning = {"position_x": np.sin(time), "position_y": np.cos(time), "velocity_x": np.cos(time)}
    return pd.DataFrame(
        {"t": time, **turning, "position_z": 1.0, "velocity_y": -np.sin(time), "velocity_z": 0.0}
    )


def test_the_animation_takes_as_long_as_the_flight(tmp_path):
    path = tmp_path / "flight.gif"
    animate_race(flight(1.5), GATE, path)
    with Image.open(path) as animation:
        frames = getattr(animation, "n_frames", 1)
        assert abs(frames * animation.info["duration"] - 1500) < 150


def test_a_race_has_its_laps_line_and_flight_on_the_page(tmp_path):
    folder = tmp_path / "evaluate"
    folder.mkdir()
    (folder / "metrics.json").write_text(json.dumps({"laps_completed": 0.95, "fastest_lap": 6.123}))
    animate_race(flight(0.3), GATE, folder / "flight.gif")
    write_page(ReportInputs.of_branch(tmp_path), tmp_path / "page.html")
    page = (tmp_path / "page.html").read_text()
    assert "fastest lap, s" in page
    assert "6.12" in page
    assert "data:image/gif;base64," in page


def test_what_was_flown_on_the_machine_stands_beside(tmp_path):
    for stage, laps in (("evaluate", 1.0), ("deploy", 0.0), ("redeploy", 0.75)):
        (tmp_path / stage).mkdir()
        (tmp_path / stage / "metrics.json").write_text(
            json.dumps({"laps_completed": laps, "completed": laps})
        )
    section = flown_section(ReportInputs.of_branch(tmp_path), Drawing())
    assert section is not None
    table = section.content["table"]
    assert [cell[:-2] for cell in table.rows[0][1:]] == ["100", "0", "75"]  # percent
    assert "\u2013" in table.rows[2]  # nobody flew a fastest lap


def test_what_the_machines_knew_of_where_they_were_is_said_where_it_was_measured(tmp_path):
    read = {"position_error": 0.27, "images": 904, "gates_found": 2119, "gates_believed": 1265}
    for stage, more in (("evaluate", {}), ("deploy", read)):
        (tmp_path / stage).mkdir()
        metrics = {"laps_completed": 1.0, "completed": 1.0} | more
        (tmp_path / stage / "metrics.json").write_text(json.dumps(metrics))
    section = flown_section(ReportInputs.of_branch(tmp_path), Drawing())
    assert section is not None
    rows = {row[0]: row[1:] for row in section.content["table"].rows}
    assert rows["error of the estimated position, RMS, m"] == ["–", "0.270"]
    assert rows["images that a gate detector read"] == ["–", "904"]
    assert rows["gates that it found"] == ["–", "2119"]
    assert not any("in view" in said for said in rows)  # nobody asked for it


def test_where_nobody_raced_there_is_no_section(tmp_path):
    folder = tmp_path / "evaluate"
    folder.mkdir()
    (folder / "metrics.json").write_text("{}")
    assert flown_section(ReportInputs.of_branch(tmp_path), Drawing()) is None
