from dataclasses import replace

import pytest
import torch

from simgap.diagnosis.drift import Drift, drifts_of
from simgap.effects import effect_by_key
from simgap.equations.fit import fit
from tests.pipeline.gap.problems import at_start, problem_of
from tests.pipeline.gap.recordings import Plant, joint_recordings, joint_simulator

RUNS = 6


def _drifts(plant: Plant, seeds: list[int]) -> list[Drift]:
    """Return the drift of viscous friction in one recording per seed; runs of 15 s hold five clusters each."""
    effect = effect_by_key("joint", "viscous_friction")
    simulator = joint_simulator(at_start(effect))
    drifts = []
    for recording in joint_recordings(plant, seeds, runs=RUNS, duration=15.0):
        problem = problem_of(recording, simulator)
        (drift,) = drifts_of(fit(simulator, problem), effect, problem.blocks, problem.cluster)
        drifts.append(drift)
    return drifts


def test_no_drift_is_found_where_there_is_none():
    """12 recordings: at a chance of 1e-3 and a spread of a quarter of the value none should be notable."""
    drifts = _drifts(Plant(viscous=0.05), list(range(12)))
    assert not any(drift.notable for drift in drifts)
    assert max(drift.spread for drift in drifts) < 0.05


def test_a_parameter_that_differs_between_runs_is_found():
    drifting = Plant(viscous=(0.02, 0.03, 0.05, 0.06, 0.08, 0.1))
    for drift in _drifts(drifting, [0, 1, 2]):
        assert drift.notable
        assert drift.spread == pytest.approx(0.54, abs=0.25)


def test_runs_too_short_to_know_their_own_error_say_nothing():
    effect = effect_by_key("joint", "viscous_friction")
    simulator = joint_simulator(at_start(effect))
    (recording,) = joint_recordings(Plant(viscous=0.05), [0], runs=4, duration=6.0)
    problem = problem_of(recording, simulator)
    assert drifts_of(fit(simulator, problem), effect, problem.blocks, torch.zeros_like(problem.cluster)) == []


def test_a_run_of_which_one_block_shows_an_effect_does_not_decide_alone():
    effect = effect_by_key("joint", "viscous_friction")
    simulator = joint_simulator(at_start(effect))
    (recording,) = joint_recordings(Plant(viscous=0.05), [0], runs=RUNS, duration=15.0)
    problem = problem_of(recording, simulator)
    fitted = fit(simulator, problem)
    silent = torch.nonzero(problem.blocks.run == 0).squeeze(1)[1:]
    jacobian = fitted.jacobian.index_fill(0, silent, 0.0)
    (drift,) = drifts_of(replace(fitted, jacobian=jacobian), effect, problem.blocks, problem.cluster)
    assert not drift.notable


def test_a_drift_is_notable_where_it_is_both_certain_and_large():
    assert Drift("a", 1.0, 1e-9).notable
    assert not Drift("a", 3.0, 0.2).notable
    assert not Drift("a", 0.1, 1e-9).notable
