"""Grey-box laws beside named effects, on flights with rotor drag."""

import json

import pytest

from benchmarks import grey_box
from simgap.effects import effect_by_key
from simgap.recordings.recording import write_recording
from simgap.simulation import Simulator
from simgap.simulation.storage import write_simulator
from tests.pipeline.gap.recordings import flight, racer


def keys(effects):
    return [effect.key for effect in effects]


def test_a_law_takes_the_place_of_the_named_forces_and_leaves_the_rest():
    named = [effect_by_key("quadrotor", key) for key in ("rotor_drag", "motor_lag", "blade_flapping_moment")]
    found = {name: keys(effects) for name, effects in grey_box.laws_of(named)}
    assert found.pop("numbers of the platform and delays") == ["motor_lag"]
    assert found.pop("named effects") == ["rotor_drag", "motor_lag", "blade_flapping_moment"]
    assert list(found) == list(grey_box.LAWS)
    assert found["rotors with inflow (Kantue & Pedro)"] == ["motor_lag", "inflow_ratio"]


def test_a_branch_that_was_not_diagnosed_is_said_in_one_line(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(
        SystemExit, match="nanodrone: there is no diagnosis; run simgap reproduce nanodrone first"
    ):
        grey_box.main(["nanodrone"])


@pytest.mark.slow
def test_a_law_is_judged_on_flights_that_were_held_out(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "artifacts" / "flights"
    (folder / "clean").mkdir(parents=True)
    (folder / "diagnose").mkdir()
    write_recording(flight(("rotor_drag", 0.35)), folder / "clean" / "recording.parquet")
    write_simulator(Simulator(racer()), folder / "build_sim")
    effects = [{"name": "rotor_drag", "probability": 0.9}, {"name": "body_drag", "probability": 0.2}]
    (folder / "diagnose" / "diagnosis.json").write_text(json.dumps({"effects": effects}))
    monkeypatch.setattr(grey_box, "LAWS", {"polynomial": ("grey_box_aerodynamics",)})
    nothing, named, polynomial = grey_box.rows_of("flights")
    assert nothing[1:] == ["0", *["100%"] * 6]
    assert named[1] == "1"
    assert int(polynomial[1]) > 25
    for row in (named, polynomial):  # the drag lies in x and y
        assert all(float(cell.rstrip("%")) < 50 for cell in row[2:4])
