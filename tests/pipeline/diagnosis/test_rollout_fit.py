"""Values that predictions over many steps know better replace those of the equations of motion; blunter ones do not."""

from dataclasses import replace

import pytest
import torch

from simgap.diagnosis.rollout_fit import (
    RolloutProblem,
    fit_with_kept_slopes,
    refit_through_rollouts,
    rollout_problem,
)
from simgap.equations.fit import Fit, fit
from simgap.equations.problem import Problem
from simgap.simulation import FittedEffect
from tests.pipeline.gap.problems import of_joint, problem_of
from tests.pipeline.gap.recordings import Plant, joint_recording, joint_simulator

_DAMPING = 0.05


def _found(noise: float) -> tuple[Fit, Problem]:
    problem = problem_of(joint_recording(Plant(viscous=_DAMPING), noise=noise), joint_simulator())
    (viscous,) = of_joint("viscous_friction")
    return fit(joint_simulator(FittedEffect(viscous, {"coefficient": 0.01})), problem), problem


def _damping(found: Fit) -> float:
    (fitted,) = found.simulator.free
    return fitted.values["coefficient"]


@pytest.mark.parametrize("noise", [0.0, 0.02])
def test_what_is_returned_damps_as_the_plant_does(noise):
    found, problem = _found(noise)
    refitted, _ = refit_through_rollouts(found, problem, horizon=0.3, folds=5)
    assert _damping(refitted) == pytest.approx(_DAMPING, rel=0.02)


def test_values_that_the_equations_of_motion_know_much_better_stay():
    """Their covariance is made a millionth: then no prediction can say anything new."""
    found, problem = _found(noise=0.02)
    sharp = replace(found, covariance=1e-6 * found.covariance)
    refitted, taken = refit_through_rollouts(sharp, problem, horizon=0.3, folds=5)
    assert not taken
    assert refitted is sharp


def test_values_that_no_prediction_bears_out_are_replaced():
    """A value 2 % off, and an error that allows for it: predictions over many steps tell the two apart."""
    found, problem = _found(noise=0.0)
    wrong = found.simulator.with_effects(
        tuple(replace(f, values={"coefficient": 1.02 * _damping(found)}) for f in found.simulator.free)
    )
    vague = replace(found, simulator=wrong, covariance=1e6 * found.covariance)
    refitted, taken = refit_through_rollouts(vague, problem, horizon=0.3, folds=5)
    assert taken
    assert _damping(refitted) == pytest.approx(_DAMPING, rel=0.005)
    (fitted,) = refitted.simulator.free
    assert fitted.std["coefficient"] < 0.02 * _DAMPING


@pytest.mark.slow
@pytest.mark.parametrize("noise", [0.0, 0.02])
def test_kept_slopes_lead_to_the_same_values_with_fewer_predictions(monkeypatch, noise):
    names = ("viscous_friction", "inertia_error", "motor_constant_error")
    wrong = ({"coefficient": 0.03}, {"ratio": 1.1}, {"ratio": 0.9})
    simulator = joint_simulator(*map(FittedEffect, of_joint(*names), wrong))
    problem = problem_of(joint_recording(Plant(viscous=_DAMPING), noise=noise), joint_simulator())
    rollouts, counted = rollout_problem(simulator, problem, horizon=0.3), []
    predicted = RolloutProblem.residual
    monkeypatch.setattr(
        RolloutProblem, "residual", lambda self, each: counted.append(each) or predicted(self, each)
    )
    kept = fit_with_kept_slopes(simulator, rollouts)
    few, counted[:] = len(counted), []
    full = fit(simulator, rollouts)
    assert kept.values.tolist() == pytest.approx(full.values.tolist(), rel=1e-4)
    torch.testing.assert_close(kept.covariance, full.covariance, rtol=1e-2, atol=0.0)
    assert few <= len(counted)


def test_a_simulator_without_free_parameters_stays_as_it_is():
    problem = problem_of(joint_recording(Plant()), joint_simulator())
    found = fit(joint_simulator(), problem)
    assert refit_through_rollouts(found, problem, horizon=0.3, folds=5) == (found, False)
