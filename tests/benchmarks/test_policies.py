import torch

from benchmarks.bare_ppo import BarePPO
from benchmarks.laps import Laps
from benchmarks.policies import BARE, OURS, settings, written
from simgap.policies.settings import Learning
from simgap.policies.training import Training
from tests.pipeline.policies.point_mass import PointMass


def test_the_project_and_the_bare_loop_learn_the_same():
    few = Learning(
        interactions=3 * 64 * 50, machines=64, horizon=50, minibatch=800, hidden=[16, 16], entropy=0.01
    )
    trained, plain = Training(PointMass(64), few, seed=2), BarePPO(PointMass(64), few, seed=2)
    before = [parameter.detach().clone() for parameter in plain.gaussian.parameters()]
    trained.run()
    for _ in range(3):
        plain.update()
    for one, other, first in zip(
        trained.learner.gaussian.parameters(), plain.gaussian.parameters(), before, strict=True
    ):
        torch.testing.assert_close(one, other, rtol=1e-3, atol=1e-4)
        assert not torch.allclose(one, first, rtol=1e-3, atol=1e-4)


def test_the_page_states_the_ratio_and_where_the_time_goes():
    laps = {OURS: Laps((30_000.0, 50_000.0, 40_000.0)), BARE: Laps((40_000.0, 50_000.0, 50_000.0))}
    page = written(laps, {"physics": 0.25, "learning": 0.75}, settings(2), 3, 2, "A machine.")
    assert "| simgap | 40,000 (30,000–50,000) |" in page
    assert "| simgap over the bare loop | 80% |" in page
    assert "| learning | 750 | 75% |" in page
    assert "take 42 minutes" in page
