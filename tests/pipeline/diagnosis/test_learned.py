"""What remains is learned where it comes back, and nothing is learned of noise."""

import pytest
import torch

from simgap.diagnosis.evidence import learned, samples
from simgap.diagnosis.learned import learn
from simgap.diagnosis.regimes import Regime
from simgap.platforms.mechanism import Channel
from tests.pipeline.gap.problems import diagnosed, problem_of, quick
from tests.pipeline.gap.recordings import Plant, joint_recording, joint_simulator

TORQUE = Channel("torque", "torque", "N·m")


def test_what_remains_is_learned_and_predicts_runs_that_were_held_out():
    """A spring that stiffens, with nothing in the catalogue that might be named for it."""
    plant = Plant(other=lambda q, v: -2e-4 * q**3)
    found = quick(joint_recording(plant), joint_simulator(), ["viscous_friction", "current_limit"])
    (entry,) = found.learned
    assert entry.channel.name == "torque"
    assert "elapsed" not in entry.features
    assert found.validation.learned is not None
    assert found.validation.learned < 0.5 * found.validation.after
    table = samples(entry)
    assert list(table.columns) == [*entry.features, "residual"]
    assert learned(found)["channels"][0]["samples"] == len(table)


@pytest.mark.slow
def test_nothing_is_learned_where_nothing_is_left():
    for plant in (Plant(), Plant(friction=0.3)):
        found = diagnosed(plant)
        assert (found.learned, found.validation.learned) == ([], None)
        assert learned(found) == {"after": None, "gap_closed": None, "channels": []}


@pytest.mark.parametrize("seed", range(5))
def test_noise_that_is_greater_than_believed_teaches_nothing(seed: int):
    """White rows of twice the deviation: more than the floor, but nothing that comes back."""
    problem = problem_of(joint_recording(Plant()), joint_simulator())
    random = torch.Generator().manual_seed(seed)
    shape = (len(problem.blocks), len(problem.functions.centres), 1)
    rows = 2.0 * problem.noise * torch.randn(shape, generator=random, dtype=torch.float64)
    regimes = [
        Regime(name, "1", problem.blocks.inner(problem.blocks.signals[name]), name)
        for name in ("position", "velocity")
    ]
    fold = torch.arange(len(problem.blocks)) % 5
    assert learn(rows, [TORQUE], regimes, problem, fold) == []
