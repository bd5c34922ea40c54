import hashlib
import json
from pathlib import Path

import pandas as pd
import pytest
import yaml

from simgap.errors import InputError
from simgap.platforms import platform_from_config
from simgap.recordings.dataset import Dataset
from simgap.recordings.recording import read_recording
from simgap.runner import StageRun
from simgap.runner.compose import compose
from simgap.stages.record import RecordStage, record

CONF = Path(__file__).parents[2] / "conf"
SHORT = {"effects": {"rotor_drag": 0.35}, "runs": 2, "duration": 0.3}


def platform(name):
    return yaml.safe_load((CONF / "platform" / f"{name}.yaml").read_text())


def recorded(output, **kwargs):
    output.mkdir()
    record(RecordStage(**kwargs), StageRun(output))
    return output


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    output = tmp_path_factory.mktemp("record") / "flown"
    return recorded(output, platform=platform("racer"), dataset=Dataset(source="reality"), record=SHORT)


def test_the_concealed_plant_is_recorded_and_its_key_sealed(flown):
    recording = read_recording(flown / "recording.parquet")
    key = (flown / "key" / "key.json").read_bytes()
    assert hashlib.sha256(key).hexdigest() in recording.source
    (effect,) = json.loads(key)["effects"]
    assert effect["name"] == "rotor_drag"
    assert effect["parameters"]["coefficient"]["value"] == pytest.approx(0.35, rel=0.05)
    assert recording.runs == ["random_1", "circle_2"]


def test_the_same_configuration_gives_the_same_bytes(flown, tmp_path):
    again = recorded(
        tmp_path / "again", platform=platform("racer"), dataset=Dataset(source="reality"), record=SHORT
    )
    for file in ("recording.parquet", "key/key.json"):
        assert (flown / file).read_bytes() == (again / file).read_bytes()


def test_a_recording_of_ones_own_is_taken_as_it_is(flown, tmp_path):
    dataset = Dataset(source="file", files=[str(flown / "recording.parquet")])
    output = recorded(tmp_path / "own", dataset=dataset)
    original = read_recording(flown / "recording.parquet")
    pd.testing.assert_frame_equal(read_recording(output / "recording.parquet").frame, original.frame)
    assert not (output / "key").exists()


DRIVEN = {"swerve_arena": "swerve_robot"}  # machines of cases that are not called after theirs


@pytest.mark.parametrize("name", sorted(path.stem for path in (CONF / "record").glob("*.yaml")))
def test_every_configured_case_can_be_recorded(name, tmp_path):
    values = compose([f"record={name}", "record.runs=2", "record.duration=0.5"])["record"]
    known = (CONF / "platform" / f"{name}.yaml").exists()
    machine = name if known else DRIVEN.get(name, "racer")
    output = recorded(
        tmp_path / name, platform=platform(machine), dataset=Dataset(source="reality"), record=values
    )
    assert len(read_recording(output / "recording.parquet").runs) == 2
    outside = [entry["name"] for entry in json.loads((output / "key" / "key.json").read_text())["outside"]]
    assert outside == (["gimbal", "autopilot"] if name == "attitude_rig" else [])


def test_the_case_of_another_machine_is_refused_by_its_key(tmp_path):
    values = compose(["record=servo"])["record"]
    with pytest.raises(InputError, match="record: unknown key"):
        recorded(tmp_path / "x", platform=platform("racer"), dataset=Dataset(source="reality"), record=values)


@pytest.mark.parametrize("path", sorted((CONF / "platform").glob("*.yaml")), ids=lambda path: path.stem)
def test_every_platform_file_is_a_platform(path):
    platform_from_config(yaml.safe_load(path.read_text()), where=str(path))


@pytest.mark.parametrize(
    ("name", "velocity_constant", "acceleration_constant"),
    [("swerve_drivetrain", 2.7851, 0.30103), ("flywheel", 0.0088813, 0.0045649)],
)
def test_published_voltage_balances_hold(name, velocity_constant, acceleration_constant):
    joint = platform_from_config(platform(name))
    constant = joint.motor.torque_constant * joint.motor.gear_ratio
    assert constant == pytest.approx(velocity_constant, rel=1e-7)
    assert joint.inertia * joint.motor.resistance / constant == pytest.approx(acceleration_constant, rel=1e-7)


@pytest.mark.parametrize("name", ["racer", "crazyflie_brushed", "crazyflie_brushless"])
def test_quadrotors_hover_well_within_their_power(name):
    quadrotor = platform_from_config(platform(name))
    assert 0.3 < quadrotor.hover_rotor_speed / quadrotor.motor_speed_max < 0.75
