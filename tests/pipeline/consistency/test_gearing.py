"""A wrong gear ratio and a wrong motor are suspected where one of them explains both numbers of the motor."""

from dataclasses import replace

import pytest

from simgap.api.flow import diagnosed
from simgap.consistency import gear_doubts
from simgap.effects import effect_by_key
from simgap.gap.settings import Gap
from simgap.platforms import Joint, platform_from_config
from simgap.platforms.joint import JointMotor
from simgap.platforms.motors import motor_named
from simgap.recordings.cleaning.settings import Cleaning
from simgap.recordings.split import Split
from simgap.simulation import FittedEffect, Simulator
from tests.pipeline.consistency.plants import SERVO, sample, servo
from tests.pipeline.gap.recordings import JOINT, Plant, joint_recording


def geared(joint: Joint, ratio: float) -> Joint:
    assert joint.motor is not None
    return replace(joint, motor=replace(joint.motor, gear_ratio=ratio))


@pytest.mark.parametrize("told", [5.0, 7.0, 14.0, 40.0])
def test_a_wrong_gear_ratio_is_suspected_beside_friction(told):
    (said,) = gear_doubts(joint_recording(Plant(friction=0.3)), geared(JOINT, told))
    found, _, rest = said.partition("gear_ratio of ")[2].partition(" ")
    assert float(found) == pytest.approx(10.0, rel=0.02)
    assert rest.startswith(f"instead of {told:g} explains both")


@pytest.mark.parametrize("name", ["BAG", "NEO 550"])
def test_a_wrong_motor_is_suspected_by_its_name(name):
    true, told = (
        Joint(inertia=0.05, motor=JointMotor(**motor_named(each, "motor").of_joint(2, 12.0)))
        for each in (name, "NEO")
    )
    (said,) = gear_doubts(servo(0.1, joint=true), told)
    assert f"the motor {name} instead of NEO" in said
    assert gear_doubts(servo(0.1, joint=true), true) == []


@pytest.mark.parametrize(
    "plant",
    [
        Plant(friction=0.3),
        Plant(inertia=0.5),
        Plant(inertia=2.0),
        Plant(viscous=0.2),
        Plant(motor_constant=1.15),
    ],
)
def test_other_physics_and_tolerances_are_no_gear(plant):
    assert gear_doubts(joint_recording(plant), JOINT) == []


def test_of_good_recordings_nothing_is_suspected():
    assert gear_doubts(servo(), SERVO) == []
    for one in sample("joint"):
        assert gear_doubts(one.recording, platform_from_config(one.platform)) == []


def test_the_answer_says_it_unless_a_number_was_corrected_already():
    wrong = geared(JOINT, 20.0)
    corrected = FittedEffect(effect_by_key("joint", "motor_constant_error"), {"ratio": 0.5}, known=True)
    for known, count in (((), 1), ((corrected,), 0)):
        found = diagnosed(
            joint_recording(Plant(friction=0.3)),
            Simulator(wrong, known),
            Gap(budget=1e-6, resamples=50, horizon=0.05, effects=["coulomb_friction"]),
            Cleaning(),
            Split(),
        )
        assert sum("gear_ratio" in warning for warning in found.document["warnings"]) == count
