"""A joint of an MJCF: shapes, defaults, actuators and what is refused."""

import math

import numpy as np
import pytest

from simgap.errors import InputError
from simgap.robot_files import read_robot_file
from tests.pipeline.robot_files.robots import keys, mjcf

HINGE = '<joint name="j" axis="0 1 0"/>'
BALL = '<geom type="sphere" size="0.1" mass="2" pos="0 0 -0.5"/>'


def body(*content: str, attributes: str = "") -> str:
    return f"<body {attributes}>{''.join(content)}</body>"


@pytest.mark.parametrize(
    ("shape", "about_z", "about_y"),
    [
        ('type="sphere" size="0.1"', 2 / 5 * 0.1**2, 2 / 5 * 0.1**2),
        ('size="0.1"', 2 / 5 * 0.1**2, 2 / 5 * 0.1**2),
        ('type="box" size="0.1 0.2 0.3"', (0.1**2 + 0.2**2) / 3, (0.1**2 + 0.3**2) / 3),
        ('type="cylinder" size="0.1 0.3"', 0.1**2 / 2, 0.1**2 / 4 + 0.3**2 / 3),
        ('type="ellipsoid" size="0.1 0.2 0.3"', (0.1**2 + 0.2**2) / 5, (0.1**2 + 0.3**2) / 5),
        ('type="capsule" size="0.1 1e-12"', 2 / 5 * 0.1**2, 2 / 5 * 0.1**2),
        ('type="capsule" size="1e-6 0.3"', 0.0, 0.3**2 / 3),
        ('type="cylinder" fromto="0 0 -0.3 0 0 0.3" size="0.1"', 0.1**2 / 2, 0.1**2 / 4 + 0.3**2 / 3),
        ('type="cylinder" fromto="0 -0.3 0 0 0.3 0" size="0.1"', 0.1**2 / 4 + 0.3**2 / 3, 0.1**2 / 2),
        ('type="box" fromto="0 0 0.3 0 0 -0.3" size="0.1"', (0.1**2 + 0.1**2) / 3, (0.1**2 + 0.3**2) / 3),
    ],
)
def test_a_shape_about_axes_through_its_centre(tmp_path, shape, about_z, about_y):
    for axis, expected in (("0 0 1", about_z), ("0 1 0", about_y)):
        text = mjcf(body(f'<joint axis="{axis}"/>', f'<geom {shape} mass="3"/>'))
        assert keys(text, tmp_path)["inertia"] == pytest.approx(3.0 * expected, rel=1e-5, abs=1e-9)


def test_a_capsule_is_two_half_spheres_and_a_cylinder(tmp_path):
    """Its inertia about its long axis, from volumes worked out by hand; the density is water's by default."""
    text = mjcf(body('<joint axis="0 0 1"/>', '<geom type="capsule" size="0.1 0.2"/>'))
    cylinder, ball = 1000 * math.pi * 0.1**2 * 0.4, 1000 * 4 / 3 * math.pi * 0.1**3
    assert keys(text, tmp_path)["inertia"] == pytest.approx(cylinder * 0.005 + ball * 0.004)


def test_a_ball_on_a_massless_string(tmp_path):
    found = keys(mjcf(body(HINGE, BALL)), tmp_path)
    assert found["inertia"] == pytest.approx(2.0 * (0.5**2 + 0.4 * 0.1**2))
    assert found["gravity_torque"] == pytest.approx(2.0 * 9.81 * 0.5)


def test_the_rotor_counts_and_gravity_is_that_of_the_file(tmp_path):
    before = '<option gravity="0 0 -1.62"/><default><joint armature="0.05"/></default>'
    found = keys(mjcf(body(HINGE, BALL), before), tmp_path)
    assert found["inertia"] == pytest.approx(0.05 + 2.0 * (0.5**2 + 0.4 * 0.1**2))
    assert found["gravity"] == pytest.approx(1.62)
    assert found["gravity_torque"] == pytest.approx(2.0 * 1.62 * 0.5)
    assert not any("inertia of the rotor" in sentence for sentence in found["assumptions"])


def test_masses_are_scaled_to_the_total_that_the_file_gives(tmp_path):
    world = body(HINGE, BALL) + body('<geom size="0.1" mass="6"/>')
    plain = keys(mjcf(world), tmp_path)
    scaled = keys(mjcf(world, '<compiler settotalmass="4"/>'), tmp_path)
    for key in ("inertia", "gravity_torque"):
        assert scaled[key] == pytest.approx(0.5 * plain[key])


def test_classes_inherit_and_the_nearest_counts(tmp_path):
    before = """<default><joint armature="1"/>
      <default class="arm"><joint armature="2"/><geom mass="5"/>
        <default class="hand"><joint damping="0.5"/></default></default></default>"""
    geom = '<geom type="sphere" size="0.1"/>'
    cases = {
        "": ("", geom, 1.0, 1000 * 4 / 3 * math.pi * 0.1**3),
        "of the body": ('childclass="arm"', geom, 2.0, 5.0),
        "of one in another": ('childclass="hand"', geom, 2.0, 5.0),
        "of the element": ('childclass="arm"', '<geom class="main" type="sphere" size="0.1"/>', 2.0,
                           1000 * 4 / 3 * math.pi * 0.1**3),
    }  # fmt: skip
    for attributes, shape, armature, mass in cases.values():
        text = mjcf(body('<joint axis="0 0 1"/>', shape, attributes=attributes), before)
        assert keys(text, tmp_path)["inertia"] == pytest.approx(armature + 0.4 * mass * 0.1**2)
    text = mjcf(body("<joint/>", BALL, attributes='childclass="leg"'), before)
    with pytest.raises(InputError, match="there is no default class 'leg'"):
        keys(text, tmp_path)


def test_an_inertial_goes_before_shapes_unless_the_file_says_otherwise(tmp_path):
    inertial = '<inertial pos="0 0 -0.5" mass="2" diaginertia="0.01 0.02 0.03"/>'
    mesh = '<geom type="mesh" mesh="arm" group="2"/>'
    found = keys(mjcf(body(HINGE, inertial, mesh)), tmp_path)
    assert found["inertia"] == pytest.approx(0.02 + 2.0 * 0.5**2)
    by_shapes = mjcf(body(HINGE, inertial, BALL)).replace("<compiler", '<compiler inertiafromgeom="true"')
    assert keys(by_shapes, tmp_path)["inertia"] == pytest.approx(2.0 * (0.5**2 + 0.4 * 0.1**2))
    ranged = mjcf(body(HINGE, BALL, mesh)).replace("<compiler", '<compiler inertiagrouprange="0 1"')
    assert keys(ranged, tmp_path)["inertia"] == pytest.approx(2.0 * (0.5**2 + 0.4 * 0.1**2))
    seen = mjcf(
        body(HINGE, BALL, '<geom type="mesh" mesh="arm" mass="0"/>', '<geom mesh="arm" density="0"/>')
    )
    assert keys(seen, tmp_path)["inertia"] == pytest.approx(2.0 * (0.5**2 + 0.4 * 0.1**2))


def test_a_full_inertia_is_turned_with_its_frame(tmp_path):
    """The same body written with a full tensor and with principal moments in a turned frame."""
    angle = 0.4
    turn = np.array(
        [[math.cos(angle), -math.sin(angle), 0], [math.sin(angle), math.cos(angle), 0], [0, 0, 1]]
    )
    full = turn @ np.diag([0.01, 0.02, 0.03]) @ turn.T
    entries = [full[0, 0], full[1, 1], full[2, 2], full[0, 1], full[0, 2], full[1, 2]]
    inertials = [
        f'<inertial pos="0 0 -0.5" mass="2" fullinertia="{" ".join(map(repr, map(float, entries)))}"/>',
        f'<inertial pos="0 0 -0.5" mass="2" diaginertia="0.01 0.02 0.03" euler="0 0 {angle}"/>',
        f'<inertial pos="0 0 -0.5" mass="2" diaginertia="0.01 0.02 0.03" axisangle="0 0 2 {angle}"/>',
        f'<inertial pos="0 0 -0.5" mass="2" diaginertia="0.01 0.02 0.03"'
        f' quat="{math.cos(angle / 2)} 0 0 {math.sin(angle / 2)}"/>',
        f'<inertial pos="0 0 -0.5" mass="2" diaginertia="0.01 0.02 0.03"'
        f' xyaxes="{math.cos(angle)} {math.sin(angle)} 0 {-math.sin(angle)} {math.cos(angle)} 0"/>',
    ]
    expected = full[1, 1] + 2.0 * 0.5**2
    for inertial in inertials:
        assert keys(mjcf(body(HINGE, inertial)), tmp_path)["inertia"] == pytest.approx(expected, rel=1e-12)


def test_angles_are_in_degrees_unless_the_file_says_radian(tmp_path):
    turned = body('<joint name="j" axis="0 1 0" ref="30"/>', BALL, attributes='euler="0 90 0"')
    degrees = mjcf(turned).replace('angle="radian"', "")
    radians = mjcf(turned.replace("30", repr(math.pi / 6)).replace("90", repr(math.pi / 2)))
    found = [keys(text, tmp_path) for text in (degrees, radians)]
    for each in found:  # the weight hangs at 90° before the drawn pose, which has the position 30°: at −60°
        assert each["gravity_torque"] == pytest.approx(2.0 * 9.81 * 0.5 * math.cos(math.pi / 3))


@pytest.mark.parametrize(
    ("actuator", "controller"),
    [
        ('<position joint="j" kp="20" kv="3" forcerange="-2 2"/>', (20.0, 3.0, 2.0)),
        ('<position joint="j" kp="20"/>', (20.0, None, None)),
        ('<position joint="j" kp="20" gear="3" kv="1" forcerange="-2 1"/>', (180.0, 9.0, 6.0)),
        ('<position joint="j" kp="20" forcerange="-2 2" forcelimited="false"/>', (20.0, None, None)),
        ('<position joint="j" kp="20" dampratio="0.5"/>', (20.0, math.sqrt(20.0 * 0.508), None)),
        ('<general joint="j" gainprm="25" biastype="affine" biasprm="0 -25 -5"/>', (25.0, 5.0, None)),
        ('<general joint="j" gainprm="25" biastype="affine" biasprm="0 0 -5"/>', None),
        ('<motor joint="j" gear="50" forcerange="-0.1 0.1"/>', (None, None, 5.0)),
        ('<motor joint="j"/>', None),
        ('<velocity joint="j" kv="3"/>', None),
        ('<position joint="other" kp="3"/>', None),
        ('<position tendon="j" kp="3"/>', None),
    ],
)
def test_a_position_actuator_is_a_controller(tmp_path, actuator, controller):
    text = mjcf(body(HINGE, BALL), after=f"<actuator>{actuator}</actuator>")
    names = ("proportional", "derivative", "effort_limit")
    expected = {} if controller is None else dict(zip(names, controller, strict=True))
    expected = {key: value for key, value in expected.items() if value is not None}
    assert keys(text, tmp_path).get("controller", {}) == pytest.approx(expected)


def test_an_actuator_of_something_else_is_none_of_a_joint_without_a_name(tmp_path):
    text = mjcf(
        body('<joint axis="0 1 0"/>', BALL), after='<actuator><position tendon="t" kp="3"/></actuator>'
    )
    assert "controller" not in keys(text, tmp_path)


def test_a_spring_at_rest_at_zero_is_a_stiffness(tmp_path):
    spring = '<joint name="j" axis="0 1 0" stiffness="4" springref="{}" damping="0.1" frictionloss="0.2"/>'
    found = keys(mjcf(body(spring.format(0), BALL)), tmp_path)
    assert found["stiffness"] == 4.0
    assert not any("constant_load" in sentence for sentence in found["assumptions"])
    stretched = keys(mjcf(body(spring.format(0.5), BALL)), tmp_path)
    assert stretched["stiffness"] == 4.0
    said = " ".join(stretched["assumptions"])
    assert "simulator.effects.constant_load.load=2." in said
    assert "simulator.effects.viscous_friction.coefficient=0.1." in said
    assert "simulator.effects.coulomb_friction.level=0.2." in said


def test_what_else_the_file_says_is_not_passed_over(tmp_path):
    after = """<equality><joint joint1="j"/></equality>
      <actuator><motor joint="j" gear="50"/><general joint="j" dyntype="filter" dynprm="0.1"/></actuator>"""
    said = " ".join(keys(mjcf(body(HINGE, BALL), after=after), tmp_path)["assumptions"])
    assert "equality constraints" in said
    assert "platform.motor.gear_ratio=50" in said
    assert "lag of its actuator" in said


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (mjcf(body(HINGE, '<geom mesh="arm"/>')), "geom: its mass lies in a mesh; give the body an inertial"),
        (mjcf(body(HINGE, '<geom type="sdf" mass="1"/>')), "the mass of a sdf is not read"),
        (mjcf(body(HINGE, '<geom type="box" size="0.1 0.1"/>')), "size='0.1 0.1' has fewer than 3 numbers"),
        (mjcf(body(HINGE, '<geom type="box" size="0.1 0.1 0"/>')), "the box has no size"),
        (mjcf(body(HINGE, '<geom type="sphere"/>')), "size='' has fewer than 1 numbers"),
        (mjcf(body(HINGE, '<geom size="1" shellinertia="true"/>')), "the inertia of a shell is not read"),
        (mjcf(body(HINGE)), "joint 'j' moves no mass"),
        (mjcf(body("<freejoint/>", BALL)), "has no joint that turns or slides about one axis"),
        (mjcf(body(HINGE, BALL, attributes='quat="0 0 0 0"')), "the quaternion has no direction"),
        (mjcf(body(HINGE, BALL), '<compiler boundmass="3"/>'), "compiler: boundmass is not read"),
        (mjcf(body(HINGE), '<compiler settotalmass="3"/>'), "settotalmass is given, and nothing has a mass"),
        (mjcf(body(HINGE, BALL), '<compiler eulerseq="abc"/>'), "eulerseq='abc' is no sequence"),
        (mjcf('<include file="/etc/passwd"/>'), "<include> is not read; let MuJoCo write the whole model"),
        (mjcf(body(HINGE, '<replicate count="3"/>')), "<replicate> is not read"),
    ],
)  # fmt: skip
def test_what_cannot_be_read_is_refused_in_one_line(tmp_path, text, line):
    with pytest.raises(InputError) as refused:
        keys(text, tmp_path)
    assert line in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_real_file_with_meshes_says_what_it_lacks(shared_data):
    """A hobby servo whose masses lie in meshes; with an inertial its joint can be read."""
    path = shared_data / "raw" / "hobby_servo_miuzei" / "robot.xml"
    with pytest.raises(
        InputError, match="body 'horn': geom: its mass lies in a mesh; give the body an inertial"
    ):
        read_robot_file(path, "servo")


def test_a_real_file_with_an_inertial_is_a_joint_with_a_controller(shared_data, tmp_path):
    text = (shared_data / "raw" / "hobby_servo_miuzei" / "robot.xml").read_text(encoding="utf-8")
    inertial = '<inertial pos="0.1055 0.0301 0.01535" mass="0.352" diaginertia="1e-4 1e-4 1e-4"/>'
    found = keys(
        text.replace('<body name="horn" pos="0 0 0">', f'<body name="horn" pos="0 0 0">{inertial}'), tmp_path
    )
    assert found["inertia"] == pytest.approx(0.005 + 1e-4 + 0.352 * 0.1**2)
    assert found["controller"] == {"proportional": 25.0, "derivative": 5.0, "effort_limit": 2.7}
    assert found["gravity"] == pytest.approx(9.8)
    assert "gravity_torque" not in found  # at zero the arm is level
    said = " ".join(found["assumptions"])
    assert f"gravity_load.cosine={0.352 * 9.8 * 0.1:.6g}" in said
    assert "coulomb_friction.level=0.1" in said
