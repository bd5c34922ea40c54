"""Rows that remember, and rows that do not."""

import pytest
import torch

from simgap.diagnosis.whiteness import memories_of, remembered
from simgap.platforms.mechanism import Channel
from tests.pipeline.gap.problems import diagnosed, problem_of
from tests.pipeline.gap.recordings import Plant, joint_recording, joint_simulator

TORQUE = Channel("torque", "torque", "N·m")


@pytest.fixture(scope="module")
def problem():
    return problem_of(joint_recording(Plant(friction=0.3)), joint_simulator())


def white(problem, seed: int = 0) -> torch.Tensor:
    random = torch.Generator().manual_seed(seed)
    shape = (len(problem.blocks), len(problem.functions.centres), 1)
    return torch.randn(shape, generator=random, dtype=torch.float64)


@pytest.mark.parametrize("seed", range(20))
def test_white_rows_remember_nothing(problem, seed: int):
    """Each has a chance of 0.001 to seem to; of twenty seeds, none does."""
    assert remembered(memories_of(white(problem, seed), [TORQUE], problem)) == []


def test_rows_that_swing_remember_themselves_at_the_right_lag(problem):
    rows = torch.arange(len(problem.functions.centres), dtype=torch.float64)
    phase = torch.rand(len(problem.blocks), 1, generator=torch.Generator().manual_seed(1))
    swing = torch.cos(torch.pi * (rows / 4 + 2.0 * phase))[..., None]  # its negative comes four rows later
    (memory,) = remembered(memories_of(swing + 0.1 * white(problem), [TORQUE], problem))
    step = float(problem.functions.centres[1] - problem.functions.centres[0]) * problem.blocks.time_step
    assert (memory.of, memory.lag) == ("itself", pytest.approx(4 * step))
    assert memory.correlation < -0.8
    assert "torque correlates with its own value" in memory.sentence


def test_rows_that_follow_an_earlier_input_say_which_and_by_how_much(problem):
    from simgap.physics.weak_form import mean_of

    voltage = mean_of(problem.functions, problem.blocks.inner(problem.blocks.signals["voltage"]))
    later = torch.roll(voltage - voltage.mean(), 1, dims=1)[..., None]
    found = memories_of(later + 0.01 * white(problem), [TORQUE], problem)
    (memory,) = remembered([m for m in found if m.of != "itself"])
    step = float(problem.functions.centres[1] - problem.functions.centres[0]) * problem.blocks.time_step
    assert (memory.of, memory.lag) == ("voltage", pytest.approx(step))
    assert memory.correlation > 0.95


@pytest.mark.slow
def test_a_right_simulator_leaves_no_memory():
    assert remembered(diagnosed(Plant(friction=0.3)).memories) == []
