import copy
import re
from pathlib import Path

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from simgap.errors import InputError
from simgap.platforms import Controller, Joint, Quadrotor, Swerve, platform_from_config, platform_to_config
from tests.pipeline.platforms.machines import JOINT, MACHINES, QUADROTOR, SWERVE

PLATFORM_FILES = sorted((Path(__file__).parents[3] / "conf" / "platform").glob("*.yaml"))
KINDS = pytest.mark.parametrize("kind", list(MACHINES))


def leaves(config: dict, path: tuple = ()) -> list[tuple]:
    """Return the way to every number of a configuration."""
    found = []
    for key, value in config.items() if isinstance(config, dict) else enumerate(config):
        if isinstance(value, dict | list):
            found += leaves(value, (*path, key))
        elif key != "kind":
            found.append((*path, key))
    return found


def changed(config: dict, path: tuple, value: object) -> dict:
    config = copy.deepcopy(config)
    place = config
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = value
    return config


NUMBERS = [(kind, path) for kind, machine in MACHINES.items() for path in leaves(platform_to_config(machine))]


def refusal(config: dict) -> str:
    with pytest.raises(InputError) as caught:
        platform_from_config(config)
    message = str(caught.value)
    assert "\n" not in message
    return message


@pytest.mark.parametrize("path", PLATFORM_FILES, ids=lambda path: path.stem)
def test_every_platform_file_loads(path):
    platform = platform_from_config(yaml.safe_load(path.read_text("utf-8")))
    assert isinstance(platform, Quadrotor | Swerve | Joint)


@KINDS
def test_a_platform_survives_the_way_through_its_configuration(kind):
    config = platform_to_config(MACHINES[kind])
    assert platform_from_config(yaml.safe_load(yaml.safe_dump(config))) == MACHINES[kind]


positive = st.floats(1e-9, 1e9)


@given(inertia=positive, load=st.floats(-1e3, 1e3), stiffness=st.floats(0, 1e6), gravity=st.floats(0, 30))
def test_every_joint_survives_the_way_through_its_configuration(inertia, load, stiffness, gravity):
    joint = Joint(inertia, load, stiffness, None, gravity, Controller(stiffness or None, None, 1.0 + gravity))
    assert platform_from_config(platform_to_config(joint)) == joint


@KINDS
def test_the_kind_is_seen_from_the_keys(kind):
    config = platform_to_config(MACHINES[kind])
    del config["kind"]
    assert platform_from_config(config) == MACHINES[kind]


@KINDS
def test_a_typing_error_is_met_with_the_right_key_even_where_the_kind_is_not_said(kind):
    config = platform_to_config(MACHINES[kind])
    del config["kind"]
    for key in config:
        wrong = {(key[:-1] if name == key else name): value for name, value in config.items()}
        assert f"unknown key {key[:-1]!r} for a {kind}; did you mean {key!r}?" in refusal(wrong)


@KINDS
def test_a_missing_key_is_named_unless_it_has_a_default(kind):
    config = platform_to_config(MACHINES[kind])
    optional = {"kind", "gravity", "gravity_torque", "stiffness", "motor", "thrust_ratios", "torque_ratios"}
    for key in set(config) - optional:
        less = {name: value for name, value in config.items() if name != key}
        assert f"key {key!r} is missing" in refusal(less)
    most = {name: value for name, value in config.items() if name not in optional}
    assert platform_from_config(most | {"kind": kind}).gravity == 9.81


def test_the_inertia_of_a_steered_module_is_asked_for():
    config = platform_to_config(SWERVE)
    del config["steer"]["inertia"]
    assert "platform.steer: key 'inertia' is missing" in refusal(config)


@pytest.mark.parametrize(("kind", "path"), NUMBERS, ids=str)
@pytest.mark.parametrize(
    "value", [float("nan"), float("inf"), "heavy", True, None, {"value": 1}, [1.0]], ids=str
)
def test_what_is_not_a_finite_number_is_refused_with_its_place(kind, path, value):
    message = refusal(changed(platform_to_config(MACHINES[kind]), path, value))
    assert str(path[0]) in message


@pytest.mark.parametrize(("kind", "path"), NUMBERS, ids=str)
def test_only_places_directions_and_loads_may_be_negative(kind, path):
    config = changed(platform_to_config(MACHINES[kind]), path, -1)
    if path[0] in ("rotor_positions", "rotor_directions", "module_positions", "gravity_torque"):
        platform_from_config(config)
    else:
        assert "must not be negative" in refusal(config)


@pytest.mark.parametrize(("kind", "path"), NUMBERS, ids=str)
def test_what_equations_divide_by_may_not_be_zero(kind, path):
    config = changed(platform_to_config(MACHINES[kind]), path, 0)
    if path[0] in ("rotor_positions", "module_positions", "gravity_torque", "stiffness", "gravity"):
        platform_from_config(config)
    else:
        assert refusal(config)


@pytest.mark.parametrize(
    ("kind", "key", "value"),
    [
        ("quadrotor", "inertia", [1.0, 1.0]),
        ("quadrotor", "inertia", 1.0),
        ("quadrotor", "rotor_positions", [[0.1, 0.1, 0.0]] * 3),
        ("quadrotor", "rotor_positions", [[0.1, 0.1]] * 4),
        ("quadrotor", "rotor_positions", "here"),
        ("quadrotor", "rotor_directions", [1, -1, 1]),
        ("quadrotor", "rotor_directions", [1, -1, 1, 2]),
        ("swerve", "module_positions", [[0.1, 0.1, 0.0]] * 4),
        ("swerve", "module_positions", [[0.1, 0.1]] * 5),
        ("swerve", "drive", 6.75),
        ("swerve", "drive", None),
        ("joint", "motor", "strong"),
        ("joint", "motor", {"resistance": 1.0}),
        ("joint", "inertia", [1.0, 1.0, 1.0]),
    ],
)
def test_wrong_shapes_are_refused_with_their_key(kind, key, value):
    assert f"platform.{key}" in refusal(platform_to_config(MACHINES[kind]) | {key: value})


def test_nothing_and_an_unknown_kind_are_refused():
    assert "no platform is given" in refusal({})
    assert "platform=NAME" in refusal({"kind": "joint"})
    assert "a mapping of keys is needed" in refusal(["mass", 1.0])
    for kind in ("hexapod", ["joint"], 3):
        assert "use one of joint, quadrotor, swerve" in refusal({"kind": kind, "inertia": 1.0})


def test_the_place_of_a_mistake_is_where_the_caller_says():
    with pytest.raises(InputError, match=r"^file\.yaml: key 'inertia' is missing"):
        platform_from_config({"kind": "joint", "stiffness": 1.0}, "file.yaml")


def test_integers_become_floats_and_directions_integers():
    config = platform_to_config(QUADROTOR) | {"mass": 1, "rotor_directions": [1.0, -1.0, 1.0, -1.0]}
    platform = platform_from_config(config)
    assert isinstance(platform.mass, float)
    assert platform.rotor_directions == (1, -1, 1, -1)
    assert all(isinstance(direction, int) for direction in platform.rotor_directions)


def test_what_may_be_left_out_may_be_said_to_be_absent():
    assert platform_from_config(platform_to_config(JOINT) | {"motor": None}).motor is None


@pytest.mark.parametrize(
    ("key", "ratios"), [("thrust_coefficient", "thrust_ratios"), ("torque_coefficient", "torque_ratios")]
)
def test_a_quadrotor_may_have_a_coefficient_for_each_rotor(key, ratios):
    platform = platform_from_config(platform_to_config(QUADROTOR) | {key: [1e-6, 2e-6, 3e-6, 2e-6]})
    assert getattr(platform, key) == pytest.approx(2e-6)
    assert getattr(platform, ratios) == pytest.approx((0.5, 1.0, 1.5, 1.0))
    assert platform_from_config(platform_to_config(platform)) == platform


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"thrust_coefficient": [1e-6, 1e-6, 1e-6]}, "platform.thrust_coefficient: a list of 4"),
        ({"thrust_coefficient": [1e-6, 1e-6, 1e-6, -1e-6]}, r"thrust_coefficient\[3\]: must not be negative"),
        ({"torque_ratios": [1.0, 1.0, 1.0, 1.2]}, "platform.torque_ratios: must have a mean of 1, has 1.05"),
        ({"thrust_ratios": [2.0, 1.0, 1.0, 0.0]}, r"thrust_ratios\[3\]: must not be zero"),
        (
            {"thrust_coefficient": [1e-6] * 4, "thrust_ratios": [1.0] * 4},
            "is a list, and there is 'thrust_ratios' too",
        ),
    ],
)
def test_wrong_coefficients_of_rotors_are_refused_with_their_place(changes, said):
    assert re.search(said, refusal(platform_to_config(QUADROTOR) | changes))


def test_each_number_of_a_position_loop_may_be_unknown():
    config = {"inertia": 0.03, "controller": {"proportional": None, "derivative": 0.0}}
    joint = platform_from_config(config)
    assert joint.controller == Controller(derivative=0.0)
    assert (joint.controller.given, joint.controller.unknown) == (("derivative",), ("proportional",))
    for wrong, word in (
        ({"proportional": 0.0}, "zero"),
        ({"gain": 1.0}, "gain"),
        ({"derivative": -1.0}, "negative"),
    ):
        assert word in refusal({"inertia": 0.03, "controller": wrong})


def test_all_missing_keys_are_named_at_once():
    assert "keys 'motor_speed_max', 'nominal_voltage' are missing; give them" in refusal(
        {
            key: value
            for key, value in platform_to_config(QUADROTOR).items()
            if key not in ("motor_speed_max", "nominal_voltage")
        }
    )
