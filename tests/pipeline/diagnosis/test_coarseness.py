"""Which axes were sampled too coarsely to tell what acts on them."""

from dataclasses import replace

import pytest

from simgap.diagnosis.coarseness import coarse_axes, coarseness_of
from simgap.equations.fit import fit
from simgap.equations.residuals import channels_on
from tests.pipeline.gap.problems import problem_of
from tests.pipeline.gap.recordings import GAIN, JOINT, Plant, joint_recording, joint_simulator

SETTLING = JOINT.inertia / GAIN**2  # s; resistance is 1 Ω


@pytest.mark.parametrize(
    ("friction", "samples", "coarse"),
    [(0.3, 40.0, False), (0.3, 2.1, False), (0.3, 1.9, True), (0.0, 1.0, False)],
)
def test_an_axis_is_coarse_that_settles_within_two_samples_and_leaves_more_than_noise(
    friction, samples, coarse
):
    simulator = joint_simulator()
    problem = problem_of(joint_recording(Plant(friction=friction)), simulator)
    fitted, channels = fit(simulator, problem), channels_on(simulator, problem.blocks)
    sampled = replace(problem, blocks=replace(problem.blocks, time_step=SETTLING / samples))
    axes = coarse_axes(fitted, sampled, channels)
    assert axes == ({"torque": pytest.approx(SETTLING)} if coarse else {})


def test_a_coarse_axis_is_said_with_both_times():
    assert coarseness_of({}, 0.02) == []
    (sentence,) = coarseness_of({"torque": 0.02}, 0.05)
    assert "torque: the axis settles within 0.02 s, but samples are 0.05 s apart" in sentence
