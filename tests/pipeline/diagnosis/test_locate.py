import torch

from simgap.diagnosis.locate import _worst_regime, locate
from simgap.diagnosis.regimes import Regime
from simgap.equations.fit import fit
from simgap.equations.residuals import channels_on
from tests.pipeline.gap.problems import problem_of
from tests.pipeline.gap.recordings import Plant, joint_recordings, joint_simulator


def test_the_run_in_which_a_simulator_fails_is_told():
    """Friction comes in the last of three runs."""
    simulator = joint_simulator()
    (recording,) = joint_recordings(Plant(friction=(0.0, 0.0, 0.3)), [0], runs=3)
    problem = problem_of(recording, simulator)
    blocks = problem.blocks
    speed = Regime("speed", "rad/s", blocks.inner(blocks.signals["velocity"]).abs(), "velocity")
    (found,) = locate(fit(simulator, problem).residual, channels_on(simulator, blocks), [speed], problem)
    worst, share = next(iter(found.runs.items()))
    assert worst == blocks.runs[2]
    assert share > 0.9
    assert abs(sum(found.runs.values()) - 1.0) < 1e-9


def test_a_range_that_holds_nearly_all_of_the_recording_is_not_told():
    """An error at both ends of the velocity is told by the speed, and by nothing if the speed is not looked over."""
    velocity = torch.linspace(-1.0, 1.0, 4000, dtype=torch.float64)
    residual = velocity.square()
    signed, size = (
        (Regime(name, "rad/s", values, "velocity"), values)
        for name, values in (("velocity", velocity), ("speed", velocity.abs()))
    )
    alone, found = (_worst_regime(residual, variables) for variables in ([signed], [signed, size]))
    assert (alone.everywhere, alone.low, alone.high) == (True, -1.0, 1.0)
    assert (found.everywhere, found.regime.name) == (False, "speed")
    assert 0.5 < found.low < found.high == 1.0
