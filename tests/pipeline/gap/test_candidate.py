"""What a candidate is refused for."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from torch import Tensor

from simgap.effects import effect_by_key
from simgap.gap.candidate import Judge
from simgap.gap.fit import Fit, excess_of, fit
from simgap.gap.prepare import prepare
from simgap.gap.refit import extend
from simgap.gap.settings import Gap
from simgap.simulation import FittedEffect
from tests.pipeline.gap.problems import at_start, problem_of
from tests.pipeline.gap.recordings import Plant, joint_recording, joint_simulator, recording_of

IMITATED = "smaller than the discretisation error of the equations"
FRICTION = effect_by_key("joint", "viscous_friction")


@pytest.fixture(scope="module")
def judged():
    """What a judge says of a fit of viscous friction that was altered."""
    problem = problem_of(joint_recording(Plant(viscous=0.05)), joint_simulator())
    base = fit(joint_simulator(), problem)
    fitted = fit(joint_simulator(at_start(FRICTION)), problem)
    judge = Judge(problem, Gap(), base, 20, {})
    return lambda altered: judge(FRICTION, base, replace(fitted, **altered(fitted))).refusal


def _unmoved(fitted: Fit) -> dict[str, Tensor]:
    return {"jacobian": 0.0 * fitted.jacobian}


def _unknown(fitted: Fit) -> dict[str, Tensor]:
    width = FRICTION.parameters[0].high - FRICTION.parameters[0].low
    return {"covariance": 0.0 * fitted.covariance + (1.01 * width) ** 2}


@pytest.mark.parametrize("altered", [_unmoved, _unknown])
def test_a_parameter_that_leaves_no_trace_is_refused(judged, altered):
    assert judged(altered) == "coefficient makes no difference in this recording"


def test_one_that_does_is_not(judged):
    assert judged(lambda fitted: {}) == ""


@pytest.mark.parametrize(("key", "taken", "usual"), [("dead_zone", 1e4, 0.1), ("current_limit", 0.01, 5.0)])
def test_what_takes_away_all_that_drives_is_refused(key, taken, usual):
    """Where the simulator is driven by far too much, having it driven by nothing predicts better."""
    effect = effect_by_key("joint", key)
    (parameter,) = effect.parameters
    problem = problem_of(joint_recording(Plant()), joint_simulator())
    judge = Judge(problem, Gap(), fit(joint_simulator(), problem), 20, {})
    said = [
        judge.silenced(effect, joint_simulator(FittedEffect(effect, {parameter.name: value})))
        for value in (taken, usual)
    ]
    assert said == ["removes nearly all of what drives the machine", ""]


@pytest.mark.parametrize(("times", "refusal"), [(0.5, ""), (1.5, IMITATED)])
def test_what_the_quadrature_may_make_up_is_refused(times, refusal):
    """Quadrature in one channel of so many times what the effect explains there; the other has neither."""
    problem = problem_of(joint_recording(Plant(viscous=0.05)), joint_simulator())
    base = fit(joint_simulator(), problem)
    fitted = fit(joint_simulator(at_start(FRICTION)), problem)
    explained = (base.residual.square() - fitted.residual.square()).mean((0, 1)).clamp_min(0.0)
    missed = replace(problem, quadrature=(times * explained).sqrt())
    assert Judge(missed, Gap(), base, 20, {})(FRICTION, base, fitted).refusal == refusal


@pytest.mark.parametrize(
    ("held", "refusal"),
    [
        (False, "does not improve the prediction of left-out runs"),
        (True, "no winding takes longer than 0.05 s"),
    ],
)
def test_to_listen_less_is_a_merit_only_where_the_input_was_sent_and_not_measured(held, refusal):
    """A joint at rest with a voltage that jumps from sample to sample, and a winding that would filter it."""
    random, shape = np.random.default_rng(0), (4, 1600)
    voltage, position, velocity = (size * random.standard_normal(shape) for size in (0.3, 2e-4, 2e-3))
    simulator = joint_simulator()
    problem = prepare(recording_of(voltage, position, velocity), simulator, Gap(), held=held).problem
    base = fit(simulator, problem)
    winding = effect_by_key("joint", "motor_inductance")
    filtered = extend(base, winding, problem)
    assert excess_of(filtered, problem.noise) < 0.5 * excess_of(base, problem.noise)
    judge = Judge(problem, Gap(), base, 20, {})
    assert judge(winding, base, filtered).refusal == refusal


@pytest.mark.parametrize(
    ("before", "after", "acts", "spoilt"),
    [
        ((10.0, 1000.0), (12.0, 10.0), True, False),
        ((10.0, 1000.0), (12.0, 900.0), True, True),
        ((10.0, 1000.0), (12.0, 900.0), False, False),
        ((0.5, 1000.0), (1.9, 900.0), True, False),
    ],
    ids=["a little for much", "much for a little", "by what is fitted beside it", "within what noise may"],
)
def test_what_another_equation_pays_is_held_against_what_is_won(before, after, acts, spoilt):
    """Residuals of two equations, times the noise."""
    problem = problem_of(joint_recording(Plant(viscous=0.05)), joint_simulator())
    judge = Judge(problem, Gap(), fit(joint_simulator(), problem), 20, {})
    rows = [
        (problem.noise * torch.tensor(each, dtype=torch.float64)).reshape(1, 1, 2) for each in (before, after)
    ]
    assert judge.spoilt(*rows, torch.tensor([acts, True])) == (
        "makes the prediction of torque worse" if spoilt else ""
    )
