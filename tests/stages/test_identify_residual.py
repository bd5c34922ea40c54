"""What a simulator still misses, named and learned from a recording of one's own."""

import json

import pytest

from simgap.plants.case import PlantCase
from simgap.plants.fly import fly
from simgap.recordings.recording import write_recording
from simgap.runner.command import main
from simgap.simulation import read_simulator
from simgap.stages.identify_residual import identify_residual
from tests.pipeline.policies.racing.machines import racer
from tests.stages.racing import ran


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    case = PlantCase(effects={"rotor_drag": 0.5}, runs=6, duration=6.0, hidden=["motor_speed"], estimates=1.0)
    path = tmp_path_factory.mktemp("flights") / "recording.parquet"
    write_recording(fly(case, racer(), seed=0)[0], path)
    return path


def identified(recording, folder, *overrides):
    own = (f"residual.recording={recording}", "residual.simulator=ideal", f"output={folder}")
    ran(identify_residual, "platform=racer", "tracking.enabled=false", *own, *overrides)
    return json.loads((folder / "metrics.json").read_text())


def test_flights_held_out_are_predicted_better_by_what_is_learned_and_best_by_what_is_named(
    recording, tmp_path
):
    scored = (f"residual.scored_on={{same: {recording}}}", "residual.observation.enabled=false")
    variants = {"nothing": (False, False), "learned": (False, True), "named": (True, False)}
    errors = {
        name: identified(
            recording,
            tmp_path / name,
            *scored,
            f"residual.name_first={named}",
            f"residual.dynamics.enabled={learned}",
        )["same/velocity"]
        for name, (named, learned) in variants.items()
    }
    assert errors["learned"] < 0.8 * errors["nothing"]
    assert errors["named"] < 0.6 * errors["learned"]
    (found,) = read_simulator(tmp_path / "named" / "simulator").effects
    assert found.effect.name == "rotor_drag"
    assert found.values["coefficient"] == pytest.approx(0.5, rel=0.05)


def test_so_many_seconds_are_used_as_asked_for(recording, tmp_path):
    few = ("residual.observation.samples=50", "residual.observation.iterations=2")
    five = identified(recording, tmp_path / "five", "residual.seconds=5", *few)
    ten = identified(recording, tmp_path / "ten", "residual.seconds=10", *few)
    assert five["misjudged_position_x"] != ten["misjudged_position_x"]
    assert (tmp_path / "five" / "observation" / "observation.yaml").exists()


def test_a_residual_takes_the_place_of_one_that_was_found_before(recording, tmp_path):
    learned = ("residual.observation.enabled=false",)
    identified(recording, tmp_path / "first", *learned)
    again = identified(
        recording, tmp_path / "again", *learned, f"residual.simulator={tmp_path}/first/simulator"
    )
    first = json.loads((tmp_path / "first" / "metrics.json").read_text())
    assert again == first
    (found,) = read_simulator(tmp_path / "again" / "simulator").effects
    assert found.effect.name == "recorded_residual"


def test_flights_that_are_named_and_not_there_are_an_error(tmp_path, capsys):
    with pytest.raises(SystemExit) as ended:
        main(
            identify_residual,
            [
                "platform=racer",
                f"residual.recording={tmp_path}/flights.parquet",
                f"artifacts={tmp_path}",
                "tracking.enabled=false",
            ],
        )
    assert ended.value.code == 2
    assert "flights.parquet: does not exist" in capsys.readouterr().err


def test_a_simulator_that_is_not_there_is_refused_in_one_line(recording, tmp_path, capsys):
    with pytest.raises(SystemExit) as ended:
        main(
            identify_residual,
            [
                "platform=racer",
                f"residual.recording={recording}",
                "residual.simulator=diagnose",
                f"artifacts={tmp_path}",
                "tracking.enabled=false",
            ],
        )
    assert ended.value.code == 2
    assert "does not exist" in capsys.readouterr().err
    assert not (tmp_path / "identify_residual").exists()
