"""The most that the noise of rows can be."""

from dataclasses import replace

import numpy as np
import torch

from simgap.effects import effect_by_key
from simgap.equations.noise_ceiling import noise_ceiling
from simgap.simulation import Simulator
from tests.pipeline.gap.problems import of_joint, problem_of
from tests.pipeline.gap.recordings import JOINT, Plant, joint_recordings, joint_simulator, recording_of


def test_a_law_does_not_explain_the_noise_of_its_own_signal():
    """A motor at rest: the back-EMF of a noisy speed is all that the residual holds, and friction of it would fit."""
    random, shape = np.random.default_rng(0), (4, 1600)
    voltage, position = 1e-4 * random.standard_normal(shape), 1e-7 * random.standard_normal(shape)
    simulator = Simulator(
        replace(JOINT, inertia=1e-5)
    )  # so that the noise of the motion itself counts for little
    problem = problem_of(recording_of(voltage, position, 0.02 * random.standard_normal(shape)), simulator)
    left = problem.residual(simulator).square().mean((0, 1)).sqrt()
    ceiling = noise_ceiling(simulator, problem, of_joint("viscous_friction", "coulomb_friction"))
    torch.testing.assert_close(ceiling, left, rtol=0.15, atol=0.0)


def test_what_a_law_explains_beyond_noise_lowers_the_ceiling():
    """A fifth difference cannot tell a fast motion from noise; the law of what moves can."""
    (plain,) = joint_recordings(Plant(viscous=0.2), [0], runs=4)
    simulator = joint_simulator()
    problem = problem_of(plain, simulator)
    ceiling = noise_ceiling(simulator, problem, [effect_by_key("joint", "viscous_friction")])
    left = problem.residual(simulator).square().mean((0, 1)).sqrt()
    assert (ceiling < 0.2 * left).all()
