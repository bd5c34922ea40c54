"""Motors by name: every entry is a motor, names are forgiving, and the platform that results does what is published."""

import math

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from simgap.artifacts import PROJECT_ROOT
from simgap.errors import InputError
from simgap.platforms import (
    DirectCurrentMotor,
    Joint,
    JointMotor,
    Swerve,
    platform_from_config,
    platform_to_config,
)
from simgap.platforms.mechanisms import mechanism_of
from simgap.platforms.motor_table import motors_listing, motors_page
from simgap.platforms.motors import motor_named, motors
from tests.pipeline.platforms.machines import SWERVE

EVERY = pytest.mark.parametrize("motor", motors(), ids=lambda motor: motor.name)


@EVERY
def test_every_entry_is_a_motor(motor):
    """Efficiency below one: the mechanical power of a straight line is at most what the winding leaves."""
    assert JointMotor(**motor.of_joint()).torque_constant > 0.0
    assert DirectCurrentMotor(**motor.of_axis()).resistance == pytest.approx(motor.resistance)
    assert 0.0 <= (motor.free_current or 0.0) < motor.stall_current / 4.0
    assert motor.gear_ratio >= 1.0
    assert len(motor.source) > 10
    # The stall torque of a lossless motor with this free speed; published ones scatter around it, or lose in a gear.
    ideal = motor.nominal_voltage / motor.free_speed * motor.stall_current
    assert 0.4 < motor.stall_torque / ideal < 1.4


def test_no_name_means_two_motors():
    names = [name for motor in motors() for name in (motor.name, *motor.also)]
    plain = ["".join(filter(str.isalnum, name.lower())) for name in names]
    assert len(plain) == len(set(plain))


@given(data=st.data())
def test_case_spaces_and_hyphens_do_not_matter(data):
    motor = data.draw(st.sampled_from(motors()))
    letters = [
        data.draw(st.sampled_from([letter.upper(), letter.lower(), f"{letter} ", f"-{letter}", f"_{letter}"]))
        for letter in motor.name
    ]
    assert motor_named("".join(letters), "motor") == motor


@pytest.mark.parametrize(
    ("name", "line"),
    [
        ("Krakn X60", "platform.motor: there is no motor 'Krakn X60'; did you mean 'Kraken X60'"),
        ("STS3215", "did you mean 'STS3215 12 V' or 'STS3215 7.4 V'?"),
        ("XM430", "did you mean 'XM430-W210' or 'XM430-W350'?"),
        ("hyperdrive", "there is no motor 'hyperdrive'; see simgap motors"),
        ("", "there is no motor ''; see simgap motors"),
    ],
)
def test_a_wrong_name_is_refused_with_the_nearest(name, line):
    with pytest.raises(InputError) as refused:
        platform_from_config({"inertia": 1.0, "motor": name})
    assert line in str(refused.value)
    assert "\n" not in str(refused.value)


@EVERY
def test_a_joint_turns_at_the_free_speed_where_the_friction_of_the_free_current_acts(motor):
    joint = platform_from_config({"inertia": 1.0, "motor": {"name": motor.name, "gear_ratio": 3.0}})
    constants = mechanism_of(joint).constants()
    signals = {
        "voltage": torch.tensor(motor.nominal_voltage, dtype=torch.float64),
        "velocity": torch.tensor(motor.free_speed / 3.0, dtype=torch.float64),
    }
    effort = float(mechanism_of(joint).actuate(signals, constants)["effort"])
    friction = 3.0 * motor.back_emf_constant * (motor.free_current or 0.0)
    assert effort == pytest.approx(friction, rel=1e-9, abs=1e-9)


@given(count=st.integers(1, 6), speed=st.floats(-700.0, 700.0), voltage=st.floats(-13.0, 13.0))
def test_several_motors_on_a_shaft_give_several_times_the_torque(count, speed, voltage):
    def torque(motor):
        joint = platform_from_config({"inertia": 1.0, "motor": motor})
        signals = {"voltage": torch.tensor(voltage).double(), "velocity": torch.tensor(speed).double()}
        return float(mechanism_of(joint).actuate(signals, mechanism_of(joint).constants())["effort"])

    assert torque({"name": "NEO", "count": count}) == pytest.approx(count * torque("NEO"), rel=1e-9, abs=1e-9)


def test_a_swerve_drive_takes_the_published_figures():
    config = platform_to_config(SWERVE)
    axis = {"gear_ratio": 6.75, "motor": "neo"}
    named = platform_from_config(config | {"drive": axis, "steer": axis | {"inertia": 0.05}})
    assert isinstance(named, Swerve)
    assert named.drive.motor == DirectCurrentMotor(12.0, 5676 * math.pi / 30.0, 2.6, 105.0)
    double = {"motor": {"name": "Kraken X60", "count": 2, "gear_ratio": 6.75}}
    drive = platform_from_config(config | {"drive": double}).drive
    assert drive.gear_ratio == 6.75
    assert (drive.motor.stall_torque, drive.motor.stall_current) == (2 * 7.09, 2 * 366.0)
    assert drive.motor.free_speed == pytest.approx(200.0 * math.pi)
    assert platform_from_config(platform_to_config(named)) == named


@pytest.mark.parametrize(
    ("motor", "line"),
    [
        ({"name": "NEO", "count": 0}, "platform.motor.count: a whole number of motors is needed, not 0"),
        ({"name": "NEO", "count": 1.5}, "a whole number of motors is needed, not 1.5"),
        ({"name": "NEO", "count": True}, "a whole number of motors is needed, not True"),
        ({"name": "NEO", "gear_ratio": 0}, "platform.motor.gear_ratio: a positive number is needed"),
        ({"name": "NEO", "gear_ratio": "5:1"}, "platform.motor.gear_ratio: a positive number is needed"),
        ({"name": "NEO", "resistance": 1.0}, "unknown key 'resistance' for a motor that is named"),
        ({"name": ["NEO"]}, "there is no motor"),
        ({"name": None}, "there is no motor"),
    ],
)
def test_a_wrong_entry_for_a_named_motor_is_refused_with_its_key(motor, line):
    with pytest.raises(InputError) as refused:
        platform_from_config({"kind": "joint", "inertia": 1.0, "motor": motor})
    assert line in str(refused.value)


def test_a_gear_ratio_is_given_once():
    drive = {"gear_ratio": 6.75, "motor": {"name": "NEO", "gear_ratio": 6.75}}
    with pytest.raises(InputError, match=r"platform.drive: 'gear_ratio' is given twice"):
        platform_from_config(platform_to_config(SWERVE) | {"drive": drive})


def test_a_motor_without_a_name_is_as_before():
    motor = {"resistance": 1.0, "torque_constant": 0.1}
    assert platform_from_config({"inertia": 1.0, "motor": motor}) == Joint(1.0, motor=JointMotor(1.0, 0.1))


def test_the_page_is_the_table():
    """`simgap motors --write docs/motors.md` brings it up to date."""
    assert (PROJECT_ROOT / "docs" / "motors.md").read_text(encoding="utf-8") == motors_page()


@EVERY
def test_page_and_listing_show_every_figure(motor):
    (row,) = [line for line in motors_page().splitlines() if line.startswith(f"| {motor.name} |")]
    for value in (motor.nominal_voltage, motor.stall_torque, motor.stall_current, motor.free_speed_rpm):
        assert f" {value:g} " in row
    assert motor.source in row
    assert any(line.startswith(f"{motor.name} ") for line in motors_listing().splitlines())
