import hashlib

import pandas as pd
import pytest

from simgap.errors import InputError
from simgap.plants.case import PlantCase
from simgap.plants.fly import fly
from simgap.plants.sealing import key_text
from tests.pipeline.plants.reading import assert_read_as_written

SHORT = {"runs": 3, "duration": 0.3}
DRAG = PlantCase(effects={"rotor_drag": 0.35}, **SHORT)


@pytest.fixture(scope="module")
def concealed(racer):
    return fly(DRAG, racer, seed=3)


def test_the_same_seed_gives_the_same_recording_and_another_another(racer, concealed):
    again, other = fly(DRAG, racer, seed=3)[0], fly(DRAG, racer, seed=4)[0]
    pd.testing.assert_frame_equal(concealed[0].frame, again.frame)
    assert not concealed[0].frame["position_x"].equals(other.frame["position_x"])


def test_twins_differ_by_the_effect_alone(racer, concealed):
    (recording, key), (twin, null) = concealed, fly(PlantCase(**SHORT), racer, seed=3)
    assert recording.runs == twin.runs
    assert recording.frame["t"].equals(twin.frame["t"])
    apart = (recording.frame["position_x"] - twin.frame["position_x"]).abs().max()
    assert 0 < apart < 0.5  # the same paths, but for what the drag does
    assert [entry["name"] for entry in key["effects"]] == ["rotor_drag"]
    assert null["effects"] == []


def test_the_record_carries_the_hash_of_the_sealed_key_and_not_the_key(concealed):
    recording, key = concealed
    assert hashlib.sha256(key_text(key).encode()).hexdigest() in recording.source
    assert "rotor" not in recording.source


def test_the_recording_keeps_the_contract(concealed, tmp_path):
    recording, _ = concealed
    assert recording.kind == "quadrotor"
    assert_read_as_written(recording, tmp_path)


def test_one_run_alone_can_be_flown_and_an_unknown_effect_cannot(racer):
    recording, _ = fly(PlantCase(runs=1, duration=0.1), racer, seed=0)
    assert recording.runs == ["random_1"]
    with pytest.raises(InputError, match="unknown effect"):
        fly(PlantCase(effects={"flubber": 1.0}), racer, seed=0)


EVERYTHING = {
    "steady_wind": {"wind_x": 3.0, "wind_y": 1.0},
    "body_drag": 0.03,
    "center_of_mass_offset": {"offset_x": 0.004},
    "rotor_fault": {"loss_4": 0.1},
    "slung_payload": 0.1,
    "battery_sag": 0.5,
    "command_delay": 0.01,
    "motor_lag": 0.02,
    "rotor_inertia_torque": 8e-6,
    "gyroscopic_torque": 8e-6,
    "blade_flapping_moment": 2e-3,
}


@pytest.mark.slow
def test_everything_at_once_can_be_flown(racer):
    case = PlantCase(effects=EVERYTHING, outside={"gusts": 1.0, "thrust_fade": 0.1}, runs=3, duration=4.0)
    recording, key = fly(case, racer, seed=1)
    assert {entry["name"] for entry in key["effects"]} == set(EVERYTHING)
    assert [entry["name"] for entry in key["outside"]] == ["gusts", "thrust_fade"]
    frame = recording.frame
    assert frame["position_z"].min() > 0.3
    assert (
        1.0 - 2.0 * (frame["attitude_x"] ** 2 + frame["attitude_y"] ** 2)
    ).min() > -0.2  # never on its back
    again, same = fly(case, racer, seed=1)
    pd.testing.assert_frame_equal(frame, again.frame)
    assert same == key


STRONG = {
    "vortex_ring": 0.3,
    "shifting_mass": 0.01,
    "heading_torque": 0.01,
    "arm_resonance": 0.3,
    "gusts": 2.0,
}


@pytest.mark.slow
@pytest.mark.parametrize("outside", STRONG)
def test_twins_of_what_has_no_name_keep_their_paths_and_noise(racer, outside):
    drag = {"rotor_drag": 0.35}
    strange, twin = (
        fly(
            PlantCase(effects=drag, outside=strength, autopilot="trimmed", runs=3, duration=1.0),
            racer,
            seed=2,
        )
        for strength in (
            {outside: {"gusts": 2.0, "heading_torque": 0.01, "shifting_mass": 0.01}.get(outside, 0.05)},
            {},
        )
    )
    assert strange[0].frame["t"].equals(twin[0].frame["t"])
    apart = (strange[0].frame["position_x"] - twin[0].frame["position_x"]).abs().max()
    assert apart < 0.5
    turned = (strange[0].frame["body_rate_x"] - twin[0].frame["body_rate_x"]).abs().max()
    assert max(apart, turned) > 0
    (entry,) = strange[1]["outside"]
    assert entry["name"] == outside
    assert {"channel", "depends_on", "parameters"} <= entry.keys()
    assert twin[1]["outside"] == []
