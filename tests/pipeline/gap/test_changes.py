"""Effects that begin in the middle of a recording, end there, or come and go between runs."""

import functools
import json
from dataclasses import replace

import numpy as np
import pytest
import torch

from simgap.diagnosis.contract import diagnosis_document
from simgap.diagnosis.diagnose import diagnose
from simgap.equations.fit import fit
from simgap.equations.presence import Presence
from simgap.equations.problem import Problem
from simgap.gap.reading import readings_of
from simgap.gap.search import Search
from simgap.gap.settings import Gap
from simgap.plants import case_from_config, record_case
from simgap.simulation import FittedEffect, Simulator
from tests.contract_checker import check_diagnosis
from tests.pipeline.gap.recordings import (
    TIME_STEP,
    Plant,
    flight,
    joint_recording,
    joint_simulator,
    motion,
    racer,
    recording_of,
    voltages,
    with_holdout,
)

FRICTION = 0.15
AMONG = ["coulomb_friction", "viscous_friction", "motor_constant_error", "inertia_error", "command_delay"]


def named(recording, simulator, effects=AMONG):
    """Return the diagnosis and the entries of its effects by name."""
    found = diagnose(recording, simulator, Gap(effects=effects))
    document = diagnosis_document(found)
    check_diagnosis(json.loads(json.dumps(document)), recording.kind)
    return found, {effect["name"]: effect for effect in document["effects"]}


@functools.cache
def named_where(acts, viscous=0.0):
    """Return the diagnosis of a joint that rubs in some runs, and the entries of its effects by name."""
    plant = Plant(friction=tuple(FRICTION * present for present in acts), viscous=viscous)
    return named(joint_recording(plant, runs=8), joint_simulator())


@pytest.mark.slow
@pytest.mark.parametrize(
    ("acts", "runs"),
    [
        ((0, 0, 1, 1, 1, 1, 1, 1), [f"run_{run}" for run in range(2, 8)]),
        ((1, 1, 1, 0, 0, 0, 0, 0), ["run_0", "run_1", "run_2"]),
        ((1, 0, 1, 0, 0, 1, 1, 0), ["run_0", "run_2", "run_5"]),
    ],
)
def test_friction_in_some_runs_is_named_with_these_runs(acts, runs):
    found, effects = named_where(acts)
    assert effects["coulomb_friction"]["runs"] == runs
    assert effects["coulomb_friction"]["probability"] > 0.9
    assert effects["coulomb_friction"]["parameters"]["level"]["value"] == pytest.approx(FRICTION, rel=0.02)
    assert set(effects) == {"coulomb_friction"}
    assert found.verdict == "missing_physics"


@pytest.mark.slow
def test_only_held_out_runs_with_the_effect_judge_the_fit():
    found, _ = named_where((1, 1, 1, 0, 0, 0, 0, 0))
    assert found.validation.gap_closed is None
    assert any("no run with all effects was kept for it" in warning for warning in found.warnings)
    found, _ = named_where((0, 0, 1, 1, 1, 1, 1, 1))
    assert found.validation.held_out_runs == ("run_6", "run_7")
    assert found.validation.gap_closed > 0.9


@pytest.mark.slow
def test_two_effects_that_begin_together_are_named_with_their_runs():
    acts = (0, 0, 0, 1, 1, 1, 1, 1)
    both = {
        name: tuple(size * present for present in acts)
        for name, size in (("friction", 0.15), ("viscous", 0.03))
    }
    _, effects = named(joint_recording(Plant(**both), runs=8), joint_simulator())
    assert set(effects) == {"coulomb_friction", "viscous_friction"}
    assert all(effect["runs"] == [f"run_{run}" for run in range(3, 8)] for effect in effects.values())


@pytest.mark.slow
def test_friction_in_some_runs_beside_other_friction_in_all_is_found():
    _, effects = named_where((0, 0, 0, 1, 1, 1, 1, 1), viscous=0.03)
    assert effects["coulomb_friction"]["runs"][0] == "run_3"
    assert "runs" not in effects["viscous_friction"]
    assert effects["viscous_friction"]["parameters"]["coefficient"]["value"] == pytest.approx(0.03, rel=0.05)


@pytest.mark.slow
def test_friction_that_begins_within_the_only_run_is_found_to_a_block():
    random, half = np.random.default_rng(3), 28.0
    voltage = voltages(3, 4000, random).reshape(1, -1)
    place = round(half / TIME_STEP)
    parts = motion(Plant(), voltage[:, :place]), motion(Plant(viscous=0.03), voltage[:, place:])
    position, velocity = (np.concatenate(pair, axis=1) for pair in zip(*parts, strict=True))
    position += 2e-4 * random.standard_normal(position.shape)
    velocity += 0.02 * random.standard_normal(velocity.shape)
    _, effects = named(recording_of(voltage, position, velocity), joint_simulator())
    (entry,) = effects["viscous_friction"]["runs"]
    assert entry["run"] == "run_0"
    assert entry["from"] == pytest.approx(half, abs=2.0)
    assert effects["viscous_friction"]["statement"].endswith(
        f"; it acts from {entry['from']:.4g} s of run_0 on."
    )


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_what_is_there_throughout_or_not_at_all_has_no_runs(seed):
    _, effects = named(joint_recording(Plant(friction=FRICTION), seed=seed), joint_simulator())
    assert "runs" not in effects["coulomb_friction"]
    _, effects = named(joint_recording(Plant(), seed=seed), joint_simulator())
    assert not effects


@pytest.mark.slow
def test_a_propeller_damaged_from_the_third_flight_on_is_named():
    case = {"effects": {"rotor_fault": {"loss_3": 0.12}}, "runs": 8, "duration": 4.0, "begins_in_run": 3}
    recording, key = record_case(case_from_config("quadrotor", case), racer(), 0)
    assert key["acts_in_runs"] == recording.runs[2:]
    recording = with_holdout(replace(recording, cleaned=True))
    found, effects = named(recording, Simulator(racer(), ()), None)
    fault = effects["rotor_fault"]
    assert (fault["subject"], fault["runs"]) == ("3", recording.runs[2:])
    assert fault["probability"] > 0.9
    assert fault["parameters"]["loss_3"]["value"] == pytest.approx(0.12, abs=0.01)
    assert found.verdict == "missing_physics"


@pytest.mark.slow
def test_beside_each_change_that_is_followed_the_same_effects_are_tried_throughout():
    readings = readings_of(
        joint_recording(Plant(friction=(0.0, *(FRICTION,) * 7)), runs=8),
        joint_simulator(),
        Gap(effects=AMONG),
    )
    search = Search(readings, Gap())
    assert search.run(8, 300.0)
    changed = [(timing, keys) for timing, keys in search.expanded if timing[-1] is not None]
    assert changed
    assert all(((*timing[:-1], None), keys) in search.visited for timing, keys in changed)


@pytest.fixture(scope="module")
def halves() -> tuple[Problem, Simulator]:
    """Return a problem in which an effect acts in two of four runs, and a simulator with it."""
    recording = joint_recording(Plant(), runs=6)
    reading = readings_of(recording, joint_simulator(), Gap(effects=AMONG))[0]
    friction = next(e for e in reading.catalogue if e.key == "viscous_friction")
    presence = Presence(("viscous_friction",), ("run_2", "run_3", "run_4", "run_5"))
    simulator = reading.nominal.with_effects((FittedEffect(friction, {"coefficient": 0.02}),))
    return replace(reading.problem, presence=presence), simulator


def test_rows_are_those_of_the_simulator_with_the_effect_or_without_it(halves):
    problem, simulator = halves
    always = replace(problem, presence=None)
    rows, acts = problem.residual(simulator), problem.acts
    assert 0 < int(acts.sum()) < len(acts)
    torch.testing.assert_close(rows[acts], always.residual(simulator)[acts])
    bare = simulator.with_effects(())
    torch.testing.assert_close(rows[~acts], always.residual(bare)[~acts])


def test_columns_of_an_effect_that_acts_in_a_part_are_the_slopes_of_the_rows(halves):
    problem, simulator = halves
    effect = simulator.effects[0].effect
    moved = simulator.with_effects((FittedEffect(effect, {"coefficient": 0.03}),))
    slope = -(problem.residual(moved) - problem.residual(simulator)) / 0.01
    torch.testing.assert_close(problem.regressors(simulator, effect)[..., 0], slope, rtol=1e-6, atol=1e-9)
    assert float(fit(simulator, problem).values[0]) == pytest.approx(0.0, abs=2e-4)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["joint", "quadrotor"])
def test_every_effect_may_act_in_a_part_of_a_recording(kind):
    """Elsewhere rows and columns are those of the simulator without it."""
    is_joint = kind == "joint"
    recording = joint_recording(Plant(), runs=6) if is_joint else flight()
    reading = readings_of(recording, joint_simulator() if is_joint else Simulator(racer(), ()), Gap())[0]
    problem = reading.problem
    for effect in reading.catalogue:
        presence = Presence((effect.key,), problem.blocks.runs[3:])
        partly = replace(problem, presence=presence)
        simulator = reading.nominal.with_effects((FittedEffect(effect, effect.defaults()),))
        elsewhere = ~partly.acts
        assert bool(elsewhere.any()), effect.key
        rows = partly.residual(simulator)[elsewhere]
        torch.testing.assert_close(rows, problem.residual(reading.nominal)[elsewhere], msg=effect.key)
        columns = partly.regressors(simulator, effect)
        assert columns is None or not columns[elsewhere].any(), effect.key
