"""Effects that only add to what acts: their columns need no evaluation of the whole simulator."""

import functools

import pytest
import torch

from simgap.effects import Effect, effect_by_key, effects_of
from simgap.equations.fit import effect_jacobian, jacobian_of, summand_of
from simgap.gap.reading import Reading, readings_of
from simgap.gap.settings import Gap
from simgap.simulation import FittedEffect, Simulator
from tests.pipeline.gap.recordings import Plant, flight, joint_recording, joint_simulator, racer

ADDING = {
    "joint": (
        "cogging",
        "constant_load",
        "cubic_stiffness",
        "gravity_load",
        "linear_stiffness",
        "quadratic_friction",
        "viscous_friction",
    ),
    "quadrotor": ("angular_drag", "body_drag", "steady_wind", "translational_lift"),
}
"""Effects that follow from the recorded motion alone."""


@functools.cache
def reading_of(kind: str) -> Reading:
    if kind == "joint":
        return readings_of(joint_recording(Plant(viscous=0.05), runs=2), joint_simulator(), Gap())[0]
    return readings_of(flight(), Simulator(racer()), Gap())[0]


def adding(kind: str) -> list[Effect]:
    reading = reading_of(kind)
    return [e for e in effects_of(kind) if reading.problem.is_sum_with(reading.nominal, e)]


def with_defaults(nominal: Simulator, effect: Effect) -> Simulator:
    return nominal.with_effects((*nominal.effects, FittedEffect(effect, effect.defaults())))


@pytest.mark.parametrize(("kind", "key"), [(kind, key) for kind, keys in ADDING.items() for key in keys])
def test_what_an_effect_adds_is_what_the_whole_simulator_shows(kind, key):
    effect = effect_by_key(kind, key)
    nominal, problem = reading_of(kind).nominal, reading_of(kind).problem
    taken, columns = summand_of(effect, effect.defaults(), nominal, problem)
    simulator = with_defaults(nominal, effect)
    whole = problem.residual(nominal) - problem.residual(simulator)
    size = float(whole.abs().max())
    torch.testing.assert_close(taken, whole, rtol=1e-9, atol=1e-9 * size)
    torch.testing.assert_close(
        effect_jacobian(simulator, effect, problem, problem.residual(simulator)), columns
    )
    for column, parameter in enumerate(effect.parameters):
        step = 1e-4 * parameter.default
        moved = FittedEffect(effect, effect.defaults() | {parameter.name: parameter.default + step})
        rows = problem.residual(nominal.with_effects((*nominal.effects, moved)))
        slope = (problem.residual(simulator) - rows) / step
        close = 1e-3 * float(slope.abs().max())
        torch.testing.assert_close(columns[..., column], slope, rtol=1e-3, atol=close)


@pytest.mark.parametrize("kind", ADDING)
def test_laws_of_the_recorded_motion_only_add(kind):
    assert {effect.key for effect in adding(kind)} == set(ADDING[kind])


def test_beside_dry_friction_that_holds_an_axis_nothing_only_adds():
    nominal, problem = reading_of("joint").nominal, reading_of("joint").problem
    rubbing = next(e for e in effects_of("joint") if e.key == "coulomb_friction")
    held = nominal.with_effects((FittedEffect(rubbing, {"level": 0.3}),))
    assert not any(problem.is_sum_with(held, effect) for effect in adding("joint"))
    residual = problem.residual(held)
    assert jacobian_of(held, problem, residual).shape == (*residual.shape, 1)
