"""What commands do to rows: by which simulators are compared on the side of the commands."""

from dataclasses import replace

import pytest
import torch

from simgap.effects import effect_by_key
from simgap.equations.residuals import residual_rows
from simgap.gap.reading import readings_of
from simgap.gap.settings import Gap
from simgap.simulation import FittedEffect, Simulator
from tests.pipeline.gap.recordings import Plant, flight, joint_recording, joint_simulator, racer

WEAK = 0.84
"""Thrust over nominal."""


def with_effects(nominal: Simulator, kind: str, **values: dict[str, float]) -> Simulator:
    fitted = (FittedEffect(effect_by_key(kind, key), each) for key, each in values.items())
    return nominal.with_effects((*nominal.effects, *fitted))


def test_rotors_that_are_weak_one_by_one_answer_as_a_weak_coefficient_does():
    """A spread of the rotors beside one fault is as many weak rotors: the gain must not depend on how that is said."""
    reading = readings_of(flight(), Simulator(racer()), Gap())[0]
    short = WEAK - 1.0
    loss = 1.0 - 3.0 * short - WEAK  # the spread gives rotor 4 what it takes from the others
    spread = {f"excess_{rotor}": short for rotor in (1, 2, 3)}
    one_by_one = FittedEffect(effect_by_key("quadrotor", "rotor_fault@4"), {"loss_4": loss})
    apart = with_effects(reading.nominal, "quadrotor", rotor_thrust_spread=spread)
    apart = apart.with_effects((*apart.effects, one_by_one))
    together = with_effects(
        reading.nominal,
        "quadrotor",
        thrust_coefficient_error={"ratio": WEAK},
        torque_coefficient_error={"ratio": WEAK},
    )
    factor = reading.problem.factor(apart)
    torch.testing.assert_close(factor, reading.problem.factor(together), rtol=1e-6, atol=1e-9)
    assert factor.max() == pytest.approx(1.0 / WEAK, rel=0.02)


def test_an_effect_that_joins_blocks_is_not_mixed_with_the_copies_without_commands():
    """The copies begin at the same times as the blocks: as parts of the same run they would take their place."""
    load = FittedEffect(
        effect_by_key("quadrotor", "slung_payload"), effect_by_key("quadrotor", "slung_payload").defaults()
    )
    reading = readings_of(flight(), Simulator(racer(), (replace(load, known=True),)), Gap())[0]
    problem = reading.problem
    alone = residual_rows(reading.nominal, problem.blocks, problem.functions)
    torch.testing.assert_close(problem.residual(reading.nominal), alone)


def test_the_noise_of_the_motion_grows_on_the_side_of_the_commands():
    """By how much depends on whose noise it is; what a program sends has none."""
    reading = readings_of(joint_recording(Plant()), joint_simulator(), Gap())[0]
    problem = reading.problem
    weak = with_effects(reading.nominal, "joint", input_scale_error={"ratio": 0.5})
    strong = with_effects(reading.nominal, "joint", input_scale_error={"ratio": 2.0})
    share = problem.of_motion
    assert ((share > 0.0) & (share <= 1.0)).all()
    expected = (1.0 + share * (problem.factor(weak) ** 2 - 1.0)).sqrt()
    torch.testing.assert_close(problem.loudness(weak), expected)
    assert (problem.loudness(weak) > 1.0).all()
    torch.testing.assert_close(problem.loudness(strong), torch.ones_like(share))
