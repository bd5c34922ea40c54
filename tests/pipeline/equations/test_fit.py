import numpy as np
import pytest
import torch
from scipy import stats

from simgap.effects import effect_by_key
from simgap.equations.fit import clustered_covariance, fit, jacobian_of, values_of
from simgap.equations.problem import Problem
from simgap.equations.refit import extend, shrink
from simgap.equations.residuals import residual_rows
from simgap.equations.temper import temper_of
from simgap.physics.weak_form import window_functions
from simgap.simulation import FittedEffect, Simulator, rollout
from simgap.simulation.blocks import Blocks
from simgap.simulation.motion import motion_of
from tests.pipeline.gap.problems import at_start, of_joint, problem_of, random_like
from tests.pipeline.gap.recordings import (
    Plant,
    flight,
    joint_recording,
    joint_recordings,
    joint_simulator,
    racer,
)

# A window of 0.2 s and blocks of one sample's quadrature bias values by less than a hundredth.
BIAS = 0.01
PLANTED = {
    "coulomb_friction": (Plant(friction=0.3), 0.3),
    "viscous_friction": (Plant(viscous=0.05), 0.05),
    "current_limit": (Plant(current_limit=5.0), 5.0),
    "command_delay": (Plant(delay=0.025), 0.025),
    "inertia_error": (Plant(inertia=1.3), 1.3),
    "motor_constant_error": (Plant(motor_constant=1.15), 1.15),
}


def _fitted(plant, *names):
    problem = problem_of(joint_recording(plant), joint_simulator())
    found = fit(joint_simulator(), problem)
    for effect in of_joint(*names):
        found = extend(found, effect, problem)
    return fit(found.simulator, problem)


@pytest.mark.parametrize("name", PLANTED)
def test_a_planted_parameter_is_recovered_within_three_standard_errors(name):
    plant, truth = PLANTED[name]
    found = _fitted(plant, name)
    error = float(found.covariance.sqrt()[0, 0])
    assert 0 < error < 0.05 * truth
    assert abs(float(found.values[0]) - truth) < 3.0 * error + BIAS * truth


@pytest.mark.parametrize(
    ("name", "truth"),
    [("rotor_drag", 0.35), ("body_drag", 0.03), ("axial_inflow", 0.3), ("translational_lift", 0.02)],
)
def test_a_force_planted_in_a_flight_is_recovered(name, truth):
    """Planted by this test's own formula on top of what the accelerometer of an uneventful flight read."""
    recording = flight()
    simulator = Simulator(racer(), (FittedEffect(effect_by_key("quadrotor", name), {"coefficient": 0.0}),))
    problem = problem_of(recording, simulator)
    signals = problem.blocks.signals
    velocity = signals["velocity"]
    ratio = signals["rotor_speed"].mean(-1, keepdim=True) / racer().hover_rotor_speed
    law = {
        "rotor_drag": -ratio * velocity * torch.tensor([1.0, 1.0, 0.0]),
        "axial_inflow": -ratio * velocity * torch.tensor([0.0, 0.0, 1.0]),
        "body_drag": -velocity.norm(dim=-1, keepdim=True) * velocity,
        "translational_lift": velocity[..., :2].square().sum(-1, keepdim=True)
        * torch.tensor([0.0, 0.0, 1.0]),
    }[name]
    signals["specific_force"] = signals["specific_force"] + truth * law
    found = fit(simulator, problem)
    error = float(found.covariance.sqrt()[0, 0])
    assert abs(float(found.values[0]) - truth) < 3.0 * error + BIAS * truth


def test_intervals_cover_the_truth_as_often_as_they_say():
    """40 seeds, two parameters each: the count inside 95 % intervals is within the 0.1 % tails of a binomial.

    The errors speak of noise. At 5 ms the quadrature biases values by less than a hundredth, asserted here too;
    the intervals are therefore laid round what the same motion gives without noise.
    """
    plant, truth = Plant(viscous=0.05, motor_constant=1.1), torch.tensor([0.05, 1.1], dtype=torch.float64)
    simulator = joint_simulator(*(at_start(e) for e in of_joint("viscous_friction", "motor_constant_error")))
    inside, seeds = np.zeros(2, dtype=int), list(range(40))
    pairs = (joint_recordings(plant, seeds, duration=4.0, noise=noise) for noise in (5.0, 0.0))
    for noisy, quiet in zip(*pairs, strict=True):
        problem = problem_of(noisy, simulator)
        found, centre = fit(simulator, problem), fit(simulator, problem_of(quiet, simulator)).values
        assert ((centre / truth - 1.0).abs() < BIAS).all()
        width = stats.t.ppf(0.975, int(problem.cluster.max())) * found.covariance.diagonal().sqrt()
        inside += ((found.values - centre).abs() < width).numpy()
    assert (inside >= stats.binom.ppf(1e-3, 40, 0.95)).all(), inside


def test_a_parameter_stays_on_its_bound():
    """A motor that pushes where friction should hold leaves the friction at none, not below."""
    found = _fitted(Plant(viscous=-0.05), "viscous_friction")
    assert float(found.values[0]) == 0.0


def test_a_bound_does_not_hold_back_the_others():
    found = _fitted(Plant(inertia=1.3), "inertia_error", "coulomb_friction")
    assert float(found.values[0]) == pytest.approx(1.3, rel=BIAS)
    assert 0.0 <= float(found.values[1]) < 0.005


def test_a_value_on_its_bound_has_no_error_and_does_not_widen_the_others():
    """Friction that would have to push is at none: the inertia is as well known as without it."""
    plant = Plant(viscous=-0.05, inertia=1.3)
    alone = _fitted(plant, "inertia_error").covariance
    beside = _fitted(plant, "inertia_error", "viscous_friction").covariance
    assert float(beside[1, 1]) == 0.0
    assert float(beside[0, 0]) == pytest.approx(float(alone), rel=0.05)  # of a fit that converged elsewhere


def test_coloured_residuals_widen_the_clustered_error_and_white_ones_do_not():
    """800 clusters of four blocks: the ratio of variances is known to about 10 %."""
    jacobian = torch.ones(3200, 1, 1, 1, dtype=torch.float64)
    cluster = torch.arange(3200) // 4
    scale = torch.ones(1, dtype=torch.float64)
    white = random_like((3200, 1, 1), seed=1)
    coloured = random_like((800, 1, 1), seed=2).repeat_interleave(4, dim=0)
    naive = 1.0 / 3200
    assert float(clustered_covariance(jacobian, white, scale, cluster)) == pytest.approx(naive, rel=0.15)
    assert float(clustered_covariance(jacobian, coloured, scale, cluster)) == pytest.approx(
        4 * naive, rel=0.15
    )


def test_an_unmodelled_effect_widens_the_errors_of_the_others():
    """Missing friction colours the residual: errors that took its rows for independent would be too small."""
    found = _fitted(Plant(friction=0.3), "inertia_error")
    weighted = found.jacobian / found.residual.square().mean().sqrt()
    naive = 1.0 / float(weighted.square().sum())
    assert float(found.covariance) > 1.3 * naive


def test_adding_a_linear_effect_equals_fitting_it_in_full():
    (effect,) = of_joint("viscous_friction")
    problem = problem_of(joint_recording(Plant(viscous=0.05)), joint_simulator())
    grown = extend(fit(joint_simulator(), problem), effect, problem)
    exact = fit(joint_simulator(at_start(effect)), problem)
    torch.testing.assert_close(grown.values, exact.values, rtol=1e-3, atol=0.0)
    torch.testing.assert_close(grown.residual, exact.residual, rtol=0.0, atol=1e-4)


def test_taking_a_linear_effect_out_equals_fitting_without_it():
    (effect, other) = (effect_by_key("quadrotor", name) for name in ("rotor_drag", "axial_inflow"))
    recording = flight(("rotor_drag", 0.35), ("axial_inflow", 0.3))
    both = Simulator(racer(), (at_start(effect), at_start(other)))
    problem = problem_of(recording, both)
    shrunk = shrink(fit(both, problem), effect, problem)
    exact = fit(Simulator(racer(), (at_start(other),)), problem)
    torch.testing.assert_close(shrunk.values, exact.values, rtol=1e-2, atol=0.0)
    torch.testing.assert_close(shrunk.residual, exact.residual, rtol=0.0, atol=1e-3)
    again = extend(shrunk, effect, problem)
    exact = fit(both, problem).values.sort().values
    torch.testing.assert_close(again.values.sort().values, exact, rtol=1e-2, atol=0.0)


@pytest.mark.parametrize("name", PLANTED)
def test_the_jacobian_is_the_slope_of_the_prediction(name):
    plant, truth = PLANTED[name]
    truth = 0.9 * truth  # a delay has a kink where it is a whole number of samples
    (effect,) = of_joint(name)
    parameter = effect.parameters[0].name
    simulator = joint_simulator(FittedEffect(effect, {parameter: truth}))
    problem = problem_of(joint_recording(plant), simulator)

    def rows(value):
        moved = joint_simulator(FittedEffect(effect, {parameter: value}))
        return residual_rows(moved, problem.blocks, problem.functions)

    step = 1e-4 * truth
    central = -(rows(truth + step) - rows(truth - step)) / (2.0 * step)
    found = jacobian_of(simulator, problem, rows(truth))[..., 0]
    assert values_of(simulator).tolist() == [truth]
    assert float((found - central).norm() / central.norm()) < 0.02


@pytest.mark.parametrize(("gap", "share"), [(0.15, 0.6), (0.25, 0.35), (0.5, 0.35)])
def test_play_that_no_start_comes_near_is_found(gap, share):
    """On the way to the gap the share is driven to its bound, from which no step leads back."""
    effect = effect_by_key("joint", "backlash")
    problem = _replayed(FittedEffect(effect, {"gap": gap, "motor_inertia_share": share}))
    found = extend(fit(joint_simulator(), problem), effect, problem).simulator.effects[-1]
    assert found.values["gap"] == pytest.approx(gap, rel=0.01)
    assert found.values["motor_inertia_share"] == pytest.approx(share, rel=0.01)


@pytest.mark.parametrize(("gap", "share"), [(0.35, 0.2), (0.6, 0.2), (0.8, 0.1)])
def test_a_winner_reaches_the_play_that_its_candidate_came_near(gap, share):
    effect = effect_by_key("joint", "backlash")
    problem = _replayed(FittedEffect(effect, {"gap": gap, "motor_inertia_share": share}))
    near = extend(fit(joint_simulator(), problem), effect, problem)
    assert near.simulator.effects[-1].values["gap"] == pytest.approx(gap, rel=0.15)
    assert fit(near.simulator, problem).simulator.effects[-1].values == pytest.approx(
        {"gap": gap, "motor_inertia_share": share}, rel=1e-3
    )


def _replayed(*effects: FittedEffect, machines: int = 24, step: float = 0.005) -> Problem:
    """Return what is to be fitted where a joint's simulator moved for a second under sines of held voltages."""
    time, random = step * torch.arange(201, dtype=torch.float64), torch.Generator().manual_seed(0)
    phase, rate = torch.rand(2, machines, 1, generator=random, dtype=torch.float64)
    voltage = {"voltage": 6.0 * torch.sin((2.0 + 14.0 * rate) * time + 2.0 * torch.pi * phase)}
    still = torch.zeros(machines, 2, dtype=torch.float64)
    held = {"voltage": voltage["voltage"][:, :-1]}
    states = rollout(joint_simulator(*effects), still, held, step)
    run = torch.zeros(machines, dtype=torch.long)
    signals = motion_of(joint_simulator().platform).signals(states) | voltage
    blocks = Blocks(signals, run, ("run",), run.double(), step, margin=4, samples=193, held_commands=voltage)
    functions, quiet = window_functions(blocks.samples, 0.2, step), torch.full((1,), 1e-4).double()
    return Problem(
        blocks,
        functions,
        quiet,
        torch.zeros(1).double(),
        torch.arange(machines),
        temper_of(blocks, functions, 0.2),
    )
