"""Recordings that were not read as they were made: whatever were named there would be made up."""

import json
from dataclasses import replace

import numpy as np
import pytest

from simgap.gap.contract import diagnosis_document
from simgap.gap.contradiction import agreements, contradictions
from simgap.gap.prepare import prepare
from simgap.gap.settings import Gap
from simgap.platforms import Joint
from simgap.recordings.contradiction import Contradiction
from simgap.recordings.recording import Recording
from simgap.simulation import Simulator
from tests.contract_checker import check_diagnosis
from tests.pipeline.gap.problems import named, quick
from tests.pipeline.gap.recordings import (
    JOINT,
    Plant,
    flight,
    joint_recording,
    joint_simulator,
    pulled_slowly,
    racer,
)

PLANTS = [
    Plant(friction=0.3, viscous=0.05),
    Plant(delay=0.02),
    Plant(current_limit=2.0),
    Plant(inertia=3.0, motor_constant=0.5),
    Plant(viscous=5.0, other=lambda position, velocity: -40.0 * position),
    Plant(viscous=2.0, other=lambda position, velocity: -40.0 * np.sin(position) - 3.0 * np.cos(position)),
]


def scaled(recording: Recording, column: str, factor: float) -> Recording:
    return replace(recording, frame=recording.frame.assign(**{column: factor * recording.frame[column]}))


def exchanged(recording: Recording, order: str) -> Recording:
    """Return a recording whose motors are numbered in another order."""
    columns = {
        f"{name}_{theirs}": f"{name}_{ours}"
        for ours, theirs in zip("1234", order, strict=True)
        for name in ("motor_command", "motor_speed")
    }
    return replace(recording, frame=recording.frame.rename(columns=columns))


def said(recording: Recording, simulator: Simulator, held: bool = False) -> list[Contradiction]:
    return contradictions(recording, prepare(recording, simulator, Gap(), held))


@pytest.mark.parametrize("plant", PLANTS)
def test_a_plant_with_more_physics_than_the_simulator_contradicts_nothing(plant):
    assert said(joint_recording(plant), joint_simulator()) == []


@pytest.mark.parametrize("plant", PLANTS)
def test_a_voltage_of_the_other_sign_is_no_physics(plant):
    backwards = scaled(joint_recording(plant), "voltage", -1.0)
    (found,) = said(backwards, joint_simulator())
    assert (found.column, found.suspected) == ("voltage", "sign")
    assert found.evidence.startswith("torque: the motion opposes the commands (correlation -")
    assert "'voltage'" in found.remedy
    assert found.runs == tuple(dict.fromkeys(backwards.frame["run"]))


@pytest.mark.slow
def test_a_spring_that_is_pulled_slowly_moves_against_its_acceleration():
    spring = pulled_slowly(Plant(viscous=0.5, other=lambda position, velocity: -5.0 * position))
    simulator = Simulator(Joint(inertia=JOINT.inertia))
    assert said(spring, simulator) == []
    assert "linear_stiffness" in named(quick(spring, simulator))
    assert len(said(scaled(spring, "effort", -1.0), simulator)) == 1


@pytest.mark.parametrize("plant", PLANTS)
def test_commands_in_another_unit_are_no_physics(plant):
    (found,) = said(scaled(joint_recording(plant), "voltage", 1000.0), joint_simulator())
    assert (found.column, found.suspected) == ("voltage", "unit")
    assert found.evidence.startswith("torque: by the platform file, the motion needs 1/")


def test_an_inertia_in_another_unit_is_no_physics():
    pulled = pulled_slowly(Plant(viscous=0.5, other=lambda position, velocity: -5.0 * position))
    (found,) = said(pulled, Simulator(Joint(inertia=1000.0 * JOINT.inertia)), held=True)
    assert (found.column, found.suspected) == ("effort", "unit")
    assert found.evidence.startswith("torque: by the platform file, the motion needs 999 times the effort")


def test_nothing_is_named_there_and_it_is_said_first():
    backwards = scaled(joint_recording(PLANTS[0]), "voltage", -1.0)
    found = quick(backwards, joint_simulator())
    assert (found.verdict, named(found), found.unnamed) == ("contradiction", [], [])
    assert found.warnings[0] == found.contradictions[0].sentence
    (written,) = diagnosis_document(found)["contradictions"]
    assert list(written) == ["column", "suspected", "evidence", "remedy", "runs"]
    check_diagnosis(json.loads(json.dumps(diagnosis_document(found))), "joint")


def test_nothing_is_named_with_a_rate_that_is_not_that_of_its_angle():
    found = quick(scaled(joint_recording(PLANTS[0]), "velocity", 60 / 6.2832), joint_simulator())
    assert (found.verdict, named(found)) == ("contradiction", [])
    (rate,) = found.contradictions
    assert (rate.column, rate.suspected) == ("velocity", "turns_per_minute")


def test_what_is_not_driven_has_no_direction():
    still = scaled(joint_recording(PLANTS[0]), "voltage", 0.0)
    assert agreements(joint_simulator(), prepare(still, joint_simulator(), Gap(), held=False).problem) == {}


@pytest.mark.slow
@pytest.mark.parametrize(("order", "axes"), [("2143", "yz"), ("3412", "xy"), ("4321", "xz")])
def test_motors_in_another_order_are_no_physics(order, axes):
    """Numbered from another corner, a machine turns about two axes the wrong way, and as told about the third."""
    recording = flight(("rotor_drag", 0.35))
    assert said(recording, Simulator(racer())) == []
    found = said(exchanged(recording, order), Simulator(racer()))
    assert {each.suspected for each in found} == {"motor_order"}
    told = {each.evidence.partition(":")[0] for each in found}
    assert told == {f"torque_{axis}" for axis in axes}
