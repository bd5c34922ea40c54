"""What a recording cannot tell apart is said, with the manoeuvre that would."""

from dataclasses import replace

import numpy as np
import pytest

from simgap.effects import effects_of
from simgap.effects.joint.viscous_friction import ViscousFriction
from simgap.gap import candidates
from simgap.gap.competition import Competition, Round
from simgap.gap.contract import diagnosis_document
from simgap.gap.settings import Gap
from simgap.platforms import Joint
from simgap.simulation import Simulator
from tests.pipeline.gap.problems import diagnosed, named, of_joint, problem_of, quick, value_of
from tests.pipeline.gap.recordings import (
    JOINT,
    Plant,
    joint_recording,
    joint_simulator,
    pulled_slowly,
    racer,
    uneventful_flights,
)

pytestmark = pytest.mark.slow


class Twin(ViscousFriction):
    """The same law under another name."""

    name = "twin_friction"


def test_an_effect_under_two_names_is_ambiguous(monkeypatch):
    monkeypatch.setattr(candidates, "effects_of", lambda kind: (*effects_of(kind), Twin()))
    found = quick(joint_recording(Plant(viscous=0.05)), joint_simulator())
    (name,) = named(found)
    assert name in ("viscous_friction", "twin_friction")
    assert found.probabilities[name] == pytest.approx(0.5, abs=0.05)
    assert value_of(found, name) == pytest.approx(0.05, rel=0.02)
    (ambiguity,) = diagnosis_document(found)["ambiguous"]
    assert {"viscous_friction", "twin_friction"} <= set(ambiguity["names"])
    assert "constant speeds" in ambiguity["separate_by"].lower()


def test_mass_and_thrust_are_one_where_no_torque_tells():
    """Four equal rotor speeds turn no machine: only the ratio of thrust to mass is left in the recording."""
    recording = uneventful_flights()[0]
    frame = recording.frame.copy()
    speeds = [f"motor_speed_{rotor}" for rotor in range(1, 5)]
    mean = (frame[speeds] ** 2).mean(axis=1) ** 0.5
    for column in speeds:
        frame[column] = mean
    wrong = Simulator(replace(racer(), mass=racer().mass / 1.15))
    errors = ["mass_error", "thrust_coefficient_error"]
    found = quick(replace(recording, frame=frame), wrong, errors)
    (name,) = named(found)
    truth = {"mass_error": 1.15, "thrust_coefficient_error": 1 / 1.15}[name]
    assert value_of(found, name) == pytest.approx(truth, rel=0.02)
    assert found.probabilities[name] < 0.6
    (ambiguity,) = diagnosis_document(found)["ambiguous"]
    assert set(ambiguity["names"]) == set(errors)
    assert "torque" in ambiguity["separate_by"] or "roll" in ambiguity["separate_by"]


def test_what_the_recording_tells_apart_is_not_ambiguous():
    found = diagnosed(Plant(friction=0.3))
    assert diagnosis_document(found)["ambiguous"] == []


def test_friction_greater_one_way_and_a_load_beside_friction_are_one_in_other_words():
    def friction(_: np.ndarray, velocity: np.ndarray) -> np.ndarray:
        return np.where(velocity > 0, -0.2, 0.0)

    found = quick(joint_recording(Plant(friction=0.2, other=friction)), joint_simulator())
    twins = {"constant_load", "asymmetric_friction"}
    (name,) = twins & set(named(found))
    assert found.probabilities[name] <= 0.5
    (listed,) = (
        set(entry["names"]) for entry in diagnosis_document(found)["ambiguous"] if name in entry["names"]
    )
    assert twins <= listed


def test_what_had_no_part_in_a_round_may_still_stand_in_for_its_winner():
    problem = problem_of(joint_recording(Plant(delay=0.025)), joint_simulator())
    competition = Competition(joint_simulator(), problem, Gap())
    delay, far = (competition.candidate(effect) for effect in of_joint("command_delay", "inertia_error"))
    far = replace(far, share=0.1 * delay.share)
    competition.rounds.append(Round((delay, far), delay))
    close = {effect.key for effect in competition.close_to(delay.effect)}
    assert close == {effect.key for effect in competition.catalogue} - {"inertia_error"}


def test_a_weight_is_not_a_spring_and_its_cubic_part():
    """On a short way a sine is both, and either of the two enters before the one cause that they conspire to be."""
    weight = pulled_slowly(Plant(viscous=0.5, other=lambda position, velocity: -4.0 * np.sin(position)))
    found = quick(weight, Simulator(Joint(inertia=JOINT.inertia)))
    assert set(named(found)) == {"gravity_load", "viscous_friction"}
    (load,) = (f for f in found.simulator.effects if f.effect.key == "gravity_load")
    assert load.values["sine"] == pytest.approx(4.0, rel=0.01)


def test_a_spring_and_its_cubic_part_are_not_a_weight():
    spring = pulled_slowly(
        Plant(viscous=0.5, other=lambda position, velocity: -3.0 * position - 3.0 * position**3)
    )
    found = quick(spring, Simulator(Joint(inertia=JOINT.inertia)))
    assert set(named(found)) == {"linear_stiffness", "cubic_stiffness", "viscous_friction"}
