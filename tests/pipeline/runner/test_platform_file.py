"""A file as a platform on the command line."""

from pathlib import Path

import pytest
from hydra.core.config_store import ConfigStore

from simgap.errors import InputError
from simgap.platforms import Joint, JointMotor, platform_assumptions, platform_from_config
from simgap.runner.compose import compose
from simgap.runner.platform_file import with_platform_files
from tests.pipeline.robot_files.robots import rod

ARM = "inertia: 5e-05\nmotor: {resistance: 1.2, torque_constant: 2e-2, gear_ratio: 50}\n"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A person's folder, in which the command is called."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "arm.yaml").write_text(ARM)
    (tmp_path / "robot.urdf").write_text(rod(mass=0.6, length=0.5))
    return tmp_path


@pytest.mark.parametrize("name", ["deep/a b [1]/arm.yaml", "servo.YML"])
def test_a_yaml_file_is_the_same_platform_as_by_its_name(folder, name):
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(ARM)
    (folder / "my" / "platform").mkdir(parents=True)
    (folder / "my" / "platform" / "mine.yaml").write_text(ARM)
    (by_path,) = with_platform_files([f"platform={name}"])
    stored = ConfigStore.instance().load(f"platform/{by_path.removeprefix('platform=')}.yaml").node
    by_name = compose(["platform=mine"], str(folder / "my"))["platform"]
    assert stored == by_name
    assert platform_from_config(by_name) == Joint(5e-5, motor=JointMotor(1.2, 0.02, 50.0))


def test_single_keys_of_a_file_may_be_changed(folder):
    """And the file goes before the platform of a branch."""
    changed = compose(
        ["platform=arm.yaml", "platform.inertia=2e-3", "branch=flywheel", "platform.motor.gear_ratio=10"]
    )
    assert platform_from_config(changed["platform"]) == Joint(2e-3, motor=JointMotor(1.2, 0.02, 10.0))


def test_a_joint_of_a_robot_file_with_a_named_motor(folder):
    motor = ["platform.motor.name=NEO", "platform.motor.gear_ratio=50"]
    platform = compose(["platform=robot.urdf", "joint=hinge", *motor])["platform"]
    joint = platform_from_config(platform)
    assert joint.inertia == pytest.approx(0.05)
    assert joint.gravity_torque == pytest.approx(1.4715)
    assert joint.motor.gear_ratio == 50.0
    assert any("robot.urdf" in said for said in platform_assumptions(platform))


def test_several_files_may_be_swept_over_and_are_read_anew(folder):
    def contents() -> list[object]:
        (choice,) = with_platform_files(["platform=arm.yaml,servo,robot.urdf"])
        names = choice.removeprefix("platform=").split(",")
        assert names[1] == "servo"
        store = ConfigStore.instance()
        return [store.load(f"platform/{name}.yaml").node["inertia"] for name in (names[0], names[2])]

    assert contents() == pytest.approx([5e-5, 0.05])
    (folder / "arm.yaml").write_text("inertia: 3\n")
    assert contents() == pytest.approx([3.0, 0.05])


@pytest.mark.parametrize(
    ("overrides", "line"),
    [
        (["platform=absent.yaml"], "absent.yaml: cannot be read (No such file or directory); check the path"),
        (["platform=absent.urdf"], "absent.urdf: cannot be read (No such file or directory); check the path"),
        (
            ["platform=robot.urdf", "joint=elbow"],
            "robot.urdf: there is no joint 'elbow' that turns or slides",
        ),
        (
            ["platform=arm.yaml", "joint=elbow"],
            "joint=elbow: names a joint of a URDF or MJCF file; arm.yaml is none",
        ),
        (
            ["platform=servo", "joint=elbow"],
            "joint=elbow: names a joint of a robot file; give platform=robot.urdf",
        ),
        (["joint=elbow"], "joint=elbow: names a joint of a robot file"),
        (["platform=list.yaml"], "list.yaml: is no mapping of keys; see docs/contract.md"),
        (["track=arm.yaml"], "track=arm.yaml: is a file, and a name is needed"),
    ],
)
def test_what_is_no_platform_is_refused_in_one_line(folder, overrides, line):
    (folder / "list.yaml").write_text("- 1\n")
    with pytest.raises(InputError) as refused:
        compose(overrides)
    assert line in str(refused.value)
    assert "\n" not in str(refused.value)


def test_text_of_a_file_is_not_replaced_by_anything_of_this_machine(folder, monkeypatch):
    monkeypatch.setenv("SECRET", "hidden")
    (folder / "arm.yaml").write_text('inertia: 1\nassumptions: ["${oc.env:SECRET}", "${seed}"]\n')
    assert compose(["platform=arm.yaml"])["platform"]["assumptions"] == ["${oc.env:SECRET}", "${seed}"]
