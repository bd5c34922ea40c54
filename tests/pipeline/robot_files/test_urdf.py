"""A joint of a URDF: exact solutions, what is said of it, and what is refused."""

import math

import pytest

from simgap.errors import InputError
from tests.pipeline.robot_files.robots import keys, rod

TWO_LINKS = """<robot name="arm">
  <link name="base"/>
  <link name="upper"><inertial><origin xyz="0 0 -0.2" rpy="0 0 0"/><mass value="1.5"/>
    <inertia ixx="0.02" iyy="0.03" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="lower"><inertial><origin xyz="0 0 -0.15" rpy="0 0 1.5707963267948966"/><mass value="0.8"/>
    <inertia ixx="0.006" iyy="0.005" izz="0.001" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="tool"><inertial><origin xyz="0 0 0"/><mass value="0.2"/>
    <inertia ixx="0" iyy="0" izz="0"/></inertial></link>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
    <limit effort="8" velocity="2" lower="-1" upper="1"/></joint>
  <joint name="elbow" type="continuous"><parent link="upper"/><child link="lower"/><origin xyz="0 0 -0.4"/>
    <axis xyz="0 2 0"/></joint>
  <joint name="mount" type="fixed"><parent link="lower"/><child link="tool"/><origin xyz="0 0 -0.3"/></joint>
</robot>"""

SECOND = '<joint name="two" type="fixed"><parent link="base"/><child link="rod"/></joint>'


def test_a_rod_about_its_end(tmp_path):
    """m·l²/3, and a pull of m·g·l/2 that is zero where it hangs."""
    found = keys(rod(mass=0.6, length=0.5), tmp_path)
    assert found["inertia"] == pytest.approx(0.6 * 0.5**2 / 3.0)
    assert found["gravity_torque"] == pytest.approx(0.6 * 9.81 * 0.25)
    assert found["kind"] == "joint"
    assert "gravity" not in found
    assert "controller" not in found
    assert not any("cos(position)" in sentence for sentence in found["assumptions"])
    assert any("inertia of the rotor" in sentence for sentence in found["assumptions"])


def test_a_joint_moves_all_that_hangs_on_it(tmp_path):
    """The elbow: the lower link (its frame turned by a quarter, so x is y) and the tool 0.3 m away."""
    elbow = keys(TWO_LINKS, tmp_path, "elbow", "arm.urdf")
    lower = 0.006 + 0.8 * 0.15**2 + 0.2 * 0.3**2
    assert elbow["inertia"] == pytest.approx(lower)
    assert elbow["gravity_torque"] == pytest.approx(9.81 * (0.8 * 0.15 + 0.2 * 0.3))
    shoulder = keys(TWO_LINKS, tmp_path, "shoulder", "arm.urdf")
    whole = 0.03 + 1.5 * 0.2**2 + 0.006 + 0.8 * 0.55**2 + 0.2 * 0.7**2
    assert shoulder["inertia"] == pytest.approx(whole)
    assert shoulder["gravity_torque"] == pytest.approx(9.81 * (1.5 * 0.2 + 0.8 * 0.55 + 0.2 * 0.7))
    assert shoulder["controller"] == {"effort_limit": 8.0}
    assert "moves 3 bodies of 2.5 kg" in shoulder["assumptions"][0]


def test_a_vertical_axis_has_no_gravity_torque(tmp_path):
    found = keys(
        rod(axis="0 0 1", rpy="1.5708 0 0").replace('axis xyz="0 0 1"', 'axis xyz="0 1 0"'), tmp_path
    )
    assert "gravity_torque" not in found
    assert not any("cos(position)" in sentence for sentence in found["assumptions"])


def test_a_rod_that_stands_at_zero_has_a_negative_gravity_torque(tmp_path):
    found = keys(rod(rpy=f"0 {math.pi} 0"), tmp_path)
    assert found["gravity_torque"] == pytest.approx(-0.6 * 9.81 * 0.25)


@pytest.mark.parametrize("angle", [-2.0, -0.7, 0.4, math.pi / 2, 3.0])
def test_a_zero_that_does_not_hang_is_said_with_the_part_that_is_left(tmp_path, angle):
    """A rod that is turned by an angle at position zero hangs at minus that angle: τ = −G·sin(position + angle)."""
    size = 0.6 * 9.81 * 0.25
    found = keys(rod(rpy=f"0 {angle} 0"), tmp_path)
    assert found.get("gravity_torque", 0.0) == pytest.approx(size * math.cos(angle), abs=1e-3 * size)
    (said,) = [sentence for sentence in found["assumptions"] if "cos(position)" in sentence]
    cosine, shift, whole = size * math.sin(angle), angle, size
    assert f"gravity_load.cosine={cosine:.6g}" in said
    assert f"add {shift:.6g} rad" in said
    assert f"gravity_torque={whole:.6g}" in said


def test_a_sliding_joint_has_a_mass_and_a_constant_pull(tmp_path):
    found = keys(rod(kind="prismatic", axis="0 0 1", effort=20.0), tmp_path)
    assert found["inertia"] == pytest.approx(0.6)
    assert "gravity_torque" not in found
    assert any("constant_load.load=-5.886" in sentence for sentence in found["assumptions"])
    level = keys(rod(kind="prismatic", axis="1 0 0"), tmp_path)
    assert not any("constant_load" in sentence for sentence in level["assumptions"])


def test_friction_of_the_file_is_said_and_not_used(tmp_path):
    found = keys(rod(more='<dynamics damping="0.02" friction="0.3"/><mimic joint="other"/>'), tmp_path)
    said = " ".join(found["assumptions"])
    assert "simulator.effects.viscous_friction.coefficient=0.02" in said
    assert "simulator.effects.coulomb_friction.level=0.3" in said
    assert "mimics another joint" in said
    assert set(found) == {"kind", "inertia", "gravity_torque", "assumptions"}


@pytest.mark.parametrize(
    ("text", "joint", "line"),
    [
        (TWO_LINKS, None, "has 2 joints; choose one with joint=NAME: shoulder, elbow"),
        (TWO_LINKS, "elbov", "there is no joint 'elbov' that turns or slides; did you mean 'elbow'?"),
        (TWO_LINKS, "mount", "there is no joint 'mount' that turns or slides; use one of shoulder, elbow"),
        (rod(kind="fixed"), None, "has no joint that turns or slides about one axis"),
        (rod(mass=0.0), None, "joint 'hinge' moves no mass"),
        (rod(axis="0 0 1"), None, "joint 'hinge' moves no inertia about its axis"),
        (rod(mass=-1.0), None, "link 'rod': the mass is negative, -1"),
        (rod(axis="0 0 0"), None, "joint 'hinge': xyz='0 0 0' has no direction"),
        (rod(axis="0 1"), None, "xyz='0 1' has fewer than 3 numbers"),
        (rod(axis="0 1 0 0"), None, "xyz='0 1 0 0' has more than three numbers"),
        (rod(rpy="0 nan 0"), None, "rpy='0 nan 0' is not finite"),
        (rod(rpy="0 ${pi/2} 0"), None, "rpy='0 ${pi/2} 0' is no list of numbers; expand macros first"),
        (rod().replace('child link="rod"', 'child link="stick"'), None, "the child link 'stick' is not there"),
        (rod().replace('parent link="base"', 'parent link="rod"'), None, "links form a loop"),
        (rod().replace('<link name="base"/>', "<link/>"), None, "<link> has no name"),
        (rod().replace("</robot>", SECOND + "</robot>"), None, "link 'rod' is moved by two joints"),
        ("<sdf/>", None, "begins with <sdf>; give a URDF (<robot>) or an MJCF (<mujoco>)"),
    ],
)  # fmt: skip
def test_what_is_no_robot_is_refused_in_one_line(tmp_path, text, joint, line):
    with pytest.raises(InputError) as refused:
        keys(text, tmp_path, joint, "robot.urdf")
    assert line in str(refused.value)
    assert str(tmp_path / "robot.urdf") in str(refused.value)
    assert "\n" not in str(refused.value)
