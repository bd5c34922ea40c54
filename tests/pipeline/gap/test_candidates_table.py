"""What is said of every candidate that mattered."""

import json

import pytest

from simgap.gap.candidates_table import candidates
from simgap.gap.contract import write_json
from tests.pipeline.gap.problems import diagnosed
from tests.pipeline.gap.recordings import Plant

pytestmark = pytest.mark.slow


def test_what_is_in_stands_first_and_what_went_says_why(tmp_path):
    found = diagnosed(Plant(friction=0.3), runs=6)
    first, *others = candidates(found)
    assert (first["name"], first["status"]) == ("coulomb_friction", "in")
    assert first["probability"] == found.probabilities["coulomb_friction"]
    assert first["parameters"]["level"]["value"] == pytest.approx(0.3, rel=0.05)
    assert first["parameters"]["level"]["unit"] == "N·m"
    assert {entry["status"] for entry in others} <= {"rival", "dropped", "out"}
    added = {turn.winner.effect.key for turn in found.naming.rounds if turn.winner}
    gone = {entry["name"]: entry["why"] for entry in others if entry["status"] == "dropped"}
    assert gone.keys() == added - {"coulomb_friction"}
    assert all(why.startswith("added, then dropped: ") for why in gone.values())
    stribeck = next(entry for entry in others if entry["name"] == "stribeck_friction")
    assert stribeck["share"] > 0.9
    assert stribeck["why"].startswith("beside coulomb friction: ")
    write_json(candidates(found), tmp_path / "candidates.json")
    assert len(json.loads((tmp_path / "candidates.json").read_text())) == 1 + len(others)


def test_a_perfect_simulator_has_nothing_in():
    assert not [entry for entry in candidates(diagnosed(Plant(), runs=6)) if entry["status"] == "in"]
