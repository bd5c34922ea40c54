"""What a person may hand over: paths, tables and mappings."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml

from simgap.api.diagnosing import Settings
from simgap.api.flow import with_assumptions
from simgap.api.inputs import load_recording, platform_config, settings_of
from simgap.api.simulators import build_simulator, catalogue
from simgap.artifacts import CONFIGURATION
from simgap.errors import InputError
from simgap.platforms import Joint, JointMotor, platform_from_config
from simgap.recordings.recording import write_recording
from simgap.runner.compose import compose
from tests.pipeline.gap.recordings import JOINT, Plant, joint_recording
from tests.pipeline.platforms.machines import MACHINES
from tests.pipeline.robot_files.robots import rod


def columns(samples: int = 40) -> dict[str, object]:
    time = 0.01 * np.arange(samples)
    return {
        "run": ["bench"] * samples,
        "t": time,
        "position": np.sin(time),
        "velocity": np.cos(time),
        "effort": list(-np.sin(time)),
    }


def test_path_frame_and_columns_hold_the_same(tmp_path):
    known = joint_recording(Plant(friction=0.3))
    write_recording(known, tmp_path / "bench.parquet")
    frame = known.frame
    read = [
        load_recording(str(tmp_path / "bench.parquet")),
        load_recording(tmp_path / "bench.parquet"),
        load_recording(frame),
        load_recording({str(name): frame[name].to_numpy() for name in frame}),
    ]
    for recording in read:
        pd.testing.assert_frame_equal(recording.frame, read[0].frame)
        assert recording.kind == "joint"
        assert recording.units == read[0].units
    assert load_recording(known) is known


def test_a_frame_with_any_index_is_counted_from_its_first_row():
    whole = pd.DataFrame(columns())
    later = load_recording(whole.iloc[10:].set_index(np.arange(30) + 7))
    assert len(later.frame) == 30
    assert whole.columns.tolist() == list(columns())


def test_declared_units_are_converted():
    turned = load_recording(
        columns() | {"position": np.rad2deg(np.sin(0.01 * np.arange(40)))}, units={"position": "deg"}
    )
    np.testing.assert_allclose(turned.frame["position"], load_recording(columns()).frame["position"])
    sliding = load_recording(columns(), units={"position": "m"})
    assert sliding.units["effort"] == "N"


@pytest.mark.parametrize(
    ("recording", "units", "line"),
    [
        ("nowhere.parquet", None, "nowhere.parquet: does not exist"),
        (columns() | {"t": [0.0]}, None, "recording: is no table"),
        (columns() | {"position": np.zeros((40, 3))}, None, "recording: is no table"),
        (3, None, "recording: is no table"),
        ({"run": ["a"], "t": [0.0], "position": [1.0], "velocity": [0.0]}, None, "column 'effort' is missing"),
        (columns(), {"angle": "deg"}, "units: there is no column 'angle'"),
        (columns(), {"position": "furlong"}, "unknown unit 'furlong'"),
        ("bench.csv", {"position": "deg"}, "a file declares its own units"),
    ],
)  # fmt: skip
def test_what_is_no_recording_is_refused_in_one_line(recording, units, line):
    with pytest.raises(InputError) as refused:
        load_recording(recording, units=units)
    assert line in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("platform", list(MACHINES.values()), ids=list(MACHINES))
def test_a_dataclass_a_mapping_and_a_file_are_the_same_platform(platform, tmp_path):
    config = platform_config(platform)
    (tmp_path / "mine.yaml").write_text(yaml.safe_dump(config))
    for given in (config, tmp_path / "mine.yaml", str(tmp_path / "mine.yaml")):
        assert platform_from_config(platform_config(given)) == platform


def test_every_platform_of_the_package_has_a_name():
    names = [path.stem for path in (CONFIGURATION / "platform").glob("*.yaml")]
    assert len(names) > 10
    for name in names:
        assert platform_from_config(platform_config(name))


def test_a_files_own_folder_counts(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("arm.yaml").write_text("inertia: 0.3\n")
    assert platform_config("arm.yaml") == {"inertia": 0.3}


def test_a_number_in_scientific_notation_is_a_number(tmp_path):
    (tmp_path / "arm.yaml").write_text("inertia: 5e-05\n")
    assert platform_from_config(platform_config(tmp_path / "arm.yaml")) == Joint(5e-5)


def test_a_joint_of_a_robot_file_is_a_platform(tmp_path):
    (tmp_path / "robot.urdf").write_text(rod(mass=0.6, length=0.5))
    for given, joint in ((tmp_path / "robot.urdf", "hinge"), (str(tmp_path / "robot.urdf"), None)):
        assert platform_from_config(platform_config(given, joint)).inertia == pytest.approx(0.05)
    machine = build_simulator(tmp_path / "robot.urdf", joint="hinge")
    hanging = machine.rollout(machine.state(position=0.0), np.zeros((10, 1)), dt=0.01)
    np.testing.assert_allclose(np.asarray(hanging), 0.0, atol=1e-12)
    with pytest.raises(InputError, match="there is no joint 'elbow'"):
        platform_config(tmp_path / "robot.urdf", "elbow")
    with pytest.raises(InputError, match="joint: names a joint of a URDF or MJCF file"):
        platform_config("servo", "elbow")


def test_what_a_platform_leaves_open_is_a_warning_of_the_recording(tmp_path):
    (tmp_path / "robot.urdf").write_text(rod())
    recording = with_assumptions(load_recording(columns()), platform_config(tmp_path / "robot.urdf"))
    assert any("inertia of the rotor" in warning for warning in recording.warnings)
    assert with_assumptions(recording, platform_config(JOINT)) is recording


@pytest.mark.parametrize(
    ("platform", "content", "line"),
    [
        (
            "servoo",
            "",
            "platform: there is no 'servoo'; did you mean 'servo'? or give the path of a YAML file",
        ),
        ("arm.yaml", "- 1", "arm.yaml: is no mapping of keys; see docs/contract.md"),
        ("arm.yaml", "a: [", "arm.yaml: is not plain YAML; correct the file"),
        ("arm.yaml", None, "arm.yaml: cannot be read (No such file or directory); check the path"),
        (3.0, "", "platform: a float is no platform; give a path, a mapping, a dataclass or a name"),
    ],
)
def test_what_is_no_platform_is_refused_in_one_line(platform, content, line, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    if content:
        Path(str(platform)).write_text(content)
    with pytest.raises(InputError) as refused:
        platform_config(platform)
    assert str(refused.value) == line


def test_without_settings_the_api_does_what_the_configuration_says():
    composed = compose([])
    groups = {key: composed[key] for key in ("clean", "simulator", "gap", "seed")}
    groups["dataset"] = {"split": composed["dataset"]["split"]}
    assert settings_of(Settings, groups, "settings") == Settings()


@pytest.mark.parametrize(
    ("settings", "line"),
    [
        ({"gap": {"folds": "many"}}, "gap.folds"),
        ({"gap": {"fold": 3}}, "gap: unknown key 'fold'; did you mean 'folds'?"),
        ({"model": {}}, "unknown key 'model'"),
        ({"dataset": {"importer": "table"}}, "dataset: unknown key 'importer'"),
        ([], "settings: a list is no mapping of keys"),
    ],
)
def test_a_wrong_setting_is_refused_in_one_line(settings, line):
    with pytest.raises(InputError) as refused:
        settings_of(Settings, settings, "settings")
    assert line in str(refused.value)
    assert "\n" not in str(refused.value)


def test_the_catalogue_lists_what_a_simulator_may_be_given():
    for kind in MACHINES:
        for effect in catalogue(kind):
            if effect.kind == "joint" and effect.names_physics:
                assert effect.key in repr(build_simulator(JOINT, {effect.key: {}}))
    with pytest.raises(InputError, match="unknown kind 'boat'; use one of joint, quadrotor, swerve"):
        catalogue("boat")


def test_a_wrong_simulator_is_refused():
    with pytest.raises(InputError, match="did you mean 'coulomb_friction'"):
        build_simulator(JOINT, {"coulomb_fricton": {}})
    with pytest.raises(InputError, match="unknown parameter 'size'"):
        build_simulator(JOINT, {"coulomb_friction": {"size": 1.0}})
    with pytest.raises(InputError, match="position_unit: is 'deg'; use rad or m"):
        build_simulator(Joint(1.0, motor=JointMotor(1.0, 1.0)), position_unit="deg")
