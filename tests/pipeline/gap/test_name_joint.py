"""Each effect of a joint, planted in a simulation apart from the catalogue, and what must not be named."""

from dataclasses import replace

import numpy as np
import pytest

from simgap.effects import effect_by_key
from simgap.equations.fit import fit
from simgap.equations.refit import extend
from simgap.platforms import Joint
from simgap.simulation import FittedEffect, Simulator
from tests.pipeline.gap.problems import (
    FEW,
    at_start,
    diagnosed,
    named,
    of_joint,
    problem_of,
    quick,
    value_of,
)
from tests.pipeline.gap.recordings import (
    JOINT,
    Plant,
    joint_recording,
    joint_recordings,
    joint_simulator,
)

pytestmark = pytest.mark.slow

PLANTED = {
    "coulomb_friction": (Plant(friction=0.3), 0.3),
    "viscous_friction": (Plant(viscous=0.05), 0.05),
    "current_limit": (Plant(current_limit=5.0), 5.0),
    "command_delay": (Plant(delay=0.025), 0.025),
    "inertia_error": (Plant(inertia=1.3), 1.3),
    "motor_constant_error": (Plant(motor_constant=1.15), 1.15),
}


@pytest.mark.parametrize(
    ("seed", "effects"), [(0, None), (1, (*FEW, "sensor_time_offset"))], ids=["all", "few"]
)
@pytest.mark.parametrize("name", PLANTED)
def test_the_planted_effect_is_named_and_no_other(name, seed, effects):
    """Of the whole catalogue, and with other noise of its nearest rivals."""
    plant, truth = PLANTED[name]
    found = diagnosed(plant, seed, effects=effects)
    assert named(found) == [name]
    rivals = {rival.key for rivalry in found.naming.rivalries for rival in rivalry.rivals}
    # One input and its answer: a late command and a late sensor are one and the same there.
    assert rivals == ({"sensor_time_offset"} if name == "command_delay" else set())
    assert sum(found.naming.posterior.inclusion()[key] for key in (name, *rivals)) > 0.9
    assert value_of(found, name) == pytest.approx(truth, rel=0.1)
    wrong_number = name.endswith("_error")
    assert found.verdict == ("parameter_mismatch" if wrong_number else "missing_physics")
    assert [mismatch.channel.name for mismatch in found.mismatches] == ["torque"]
    assert found.validation.gap_closed is not None
    assert found.validation.gap_closed > 0.9


def test_a_faint_effect_is_named_too():
    """Friction of a twentieth of the motor's least peak torque, the noise of the velocity fifty times the usual."""
    found = quick(joint_recording(Plant(friction=0.1), noise=20.0), joint_simulator())
    assert named(found) == ["coulomb_friction"]
    assert value_of(found, "coulomb_friction") == pytest.approx(0.1, rel=0.1)


TIMING = {"command_delay", "sensor_time_offset", "motor_lag", "velocity_filter"}
"""Effects that are the same for a short time."""


@pytest.mark.parametrize("name", [name for name in PLANTED if name != "current_limit"])
def test_six_seconds_of_one_run_are_enough(name):
    """Ramps of the voltage, in which the current stays below any limit."""
    plant, truth = PLANTED[name]
    found = quick(joint_recordings(plant, [0], runs=1, duration=6.0)[0], joint_simulator())
    rivals = {effect.key for each in found.naming.rivalries for effect in (each.winner, *each.rivals)}
    if name == "command_delay":  # under ramps a lag is a delay
        assert name in {*named(found), *rivals} <= TIMING
        assert all(probability <= 0.5 for probability in found.probabilities.values())
    else:
        assert named(found) == [name]
    assert next(iter(found.naming.named[0].fitted.values.values())) == pytest.approx(truth, rel=0.1)


@pytest.mark.parametrize("plant", [Plant(friction=0.3), Plant(delay=0.02)])
def test_of_a_quarter_of_a_second_nothing_is_said_but_that_it_is_too_short(plant):
    found = quick(joint_recordings(plant, [0], runs=1, duration=0.25)[0], joint_simulator())
    assert named(found) == []
    assert any("s could be fitted" in warning for warning in found.warnings)


def test_nothing_is_named_in_six_seconds_of_nothing():
    """Twelve recordings: none is wrong here, where one in a thousand may be."""
    for recording in joint_recordings(Plant(), list(range(12)), runs=1, duration=6.0):
        assert quick(recording, joint_simulator()).verdict == "none"


@pytest.mark.parametrize(
    ("plant", "truth"),
    [
        (Plant(friction=0.3, current_limit=5.0), {"coulomb_friction": 0.3, "current_limit": 5.0}),
        (Plant(viscous=0.04, delay=0.02), {"viscous_friction": 0.04, "command_delay": 0.02}),
        (Plant(friction=0.2, inertia=1.2), {"coulomb_friction": 0.2, "inertia_error": 1.2}),
    ],
)
def test_both_of_a_pair_are_named(plant, truth):
    found = diagnosed(plant)
    assert set(named(found)) == set(truth)
    for name, value in truth.items():
        assert value_of(found, name) == pytest.approx(value, rel=0.1)


def test_nothing_is_named_where_nothing_is():
    """Ten recordings: with at most one false verdict in a hundred, none of ten is wrong with 90 %, and none is here."""
    for recording in joint_recordings(Plant(), list(range(10))):
        found = quick(recording, joint_simulator())
        assert (found.verdict, named(found), found.unnamed) == ("none", [], [])
        assert found.validation.gap_closed == 0.0


def test_two_wrong_numbers_do_not_conspire_to_be_friction_nor_the_reverse():
    """Motor constant and inertia wrong by one ratio damp a joint as viscous friction does: one cause is likelier."""
    alone = diagnosed(Plant(viscous=0.05))
    assert named(alone) == ["viscous_friction"]
    both = diagnosed(Plant(inertia=1.4, motor_constant=0.9))
    assert set(named(both)) == {"inertia_error", "motor_constant_error"}
    assert both.verdict == "parameter_mismatch"


@pytest.mark.parametrize(
    ("other", "wave"),
    [
        (lambda q, v: -2e-4 * q**3, "position"),
        (lambda q, v: 0.3 * np.sin(6.0 * q), "sin(6·position)"),
        (lambda q, v: -0.05 * q, "position"),
    ],
    ids=["cubic_spring", "cogging", "spring"],
)
def test_what_the_catalogue_lacks_gets_a_formula_and_no_wrong_name(other, wave):
    known = {"coulomb_friction", "viscous_friction", "current_limit", "command_delay", "inertia_error"}
    found = quick(
        joint_recording(Plant(other=other)), joint_simulator(), sorted(known | {"motor_constant_error"})
    )
    assert found.verdict == "unexplained"
    assert all(probability <= 0.5 for probability in found.probabilities.values())
    (unnamed,) = found.unnamed
    assert "position" in unnamed.depends_on
    assert wave in unnamed.formula
    assert unnamed.share > 0.5


@pytest.mark.parametrize("constant", [0.75, 1.3])
def test_the_formula_of_what_has_no_name_is_in_newton_metres_beside_a_wrong_motor(constant):
    """The rows of a fit are in terms of the commands: a motor that is weaker by a quarter makes them a third larger."""
    plant = Plant(motor_constant=constant, other=lambda q, v: 0.3 * np.sin(6.0 * q))
    found = quick(joint_recording(plant), joint_simulator(), ["motor_constant_error"])
    assert value_of(found, "motor_constant_error") == pytest.approx(constant, rel=0.02)
    (unnamed,) = found.unnamed
    size, law = unnamed.formula.split("·", 1)
    assert (float(size), law) == (pytest.approx(0.3, rel=0.03), "sin(6·position)")


@pytest.mark.parametrize("late", [-0.1, 0.1])
def test_clocks_that_are_a_tenth_of_a_sample_apart_are_no_cause(late):
    recording = joint_recording(Plant())
    frame = recording.frame.copy()
    for column in ("position", "velocity"):
        series = frame[column].to_numpy().reshape(len(recording.runs), -1)
        frame[column] = (series - late * np.gradient(series, axis=1)).ravel()
    found = quick(replace(recording, frame=frame), joint_simulator())
    assert (found.verdict, named(found)) == ("none", [])
    assert {fitted.effect.key for fitted in found.simulator.effects} <= TIMING
    assert any("not named" in warning for warning in found.warnings)


@pytest.mark.parametrize("difference", [-0.2, 0.2])
def test_friction_that_is_greater_one_way_is_found_on_either_side(difference):
    """Its law has a kink at no difference, over which no fit may be led astray."""

    def friction(_: np.ndarray, velocity: np.ndarray) -> np.ndarray:
        return np.where(np.sign(velocity) == np.sign(difference), -difference, 0.0)

    problem = problem_of(joint_recording(Plant(friction=0.2, other=friction)), joint_simulator())
    coulomb, asymmetric = of_joint("coulomb_friction", "asymmetric_friction")
    known = fit(joint_simulator().with_effects((at_start(coulomb),)), problem)
    found = extend(known, asymmetric, problem).simulator.effects[-1]
    assert found.values["difference"] == pytest.approx(difference, rel=0.1)
    assert abs(found.std["difference"]) < 0.02


def test_a_known_effect_with_the_right_value_is_not_named_and_with_a_wrong_one_is():
    plant, effect = Plant(friction=0.3), effect_by_key("joint", "coulomb_friction")
    for level, expected in ((0.3, []), (0.2, ["coulomb_friction"])):
        believed = FittedEffect(effect, {"level": level}, known=True)
        found = quick(joint_recording(plant), joint_simulator(believed), FEW)
        assert named(found) == expected
        assert len(found.simulator.effects) == 1
        (final,) = found.simulator.effects
        assert final.values["level"] == pytest.approx(0.3, rel=0.02)


def test_a_sliding_axis_speaks_of_forces():
    recording = joint_recording(Plant(friction=0.3))
    sliding = replace(recording, units={"position": "m", "velocity": "m/s", "voltage": "V"})
    found = quick(sliding, Simulator(JOINT, position_unit="m"), FEW)
    assert found.mismatches[0].channel.name == "force"
    assert named(found) == ["coulomb_friction"]


def test_an_effort_in_place_of_a_voltage_serves_as_well():
    recording = joint_recording(Plant(friction=0.3))
    frame = recording.frame.copy()
    effort = 0.5 * (frame["voltage"] - 0.5 * frame["velocity"])
    frame = frame.drop(columns="voltage").assign(effort=effort)
    units = {"position": "rad", "velocity": "rad/s", "effort": "N·m"}
    found = quick(replace(recording, frame=frame, units=units), Simulator(Joint(inertia=JOINT.inertia)))
    assert "coulomb_friction" in named(found)[:1]


def test_friction_and_a_wrong_number_show_only_beside_a_load_and_a_delay():
    """Neither pair shows alone: what the one leaves hides the other, and a delay is none of what any machine has."""
    plant = Plant(
        friction=0.9, motor_constant=0.8, delay=0.02, other=lambda position, velocity: 1.2 + 0.0 * position
    )
    found = quick(joint_recording(plant), joint_simulator())
    assert set(named(found)) == {"coulomb_friction", "motor_constant_error", "constant_load", "command_delay"}
    for name, value in {"coulomb_friction": 0.9, "motor_constant_error": 0.8, "constant_load": 1.2}.items():
        assert value_of(found, name) == pytest.approx(value, rel=0.05)
