from simgap.gap.fit import fit
from simgap.gap.locate import locate
from simgap.gap.regimes import Regime
from simgap.gap.residuals import channels_on
from tests.pipeline.gap.problems import problem_of
from tests.pipeline.gap.recordings import Plant, joint_recordings, joint_simulator


def test_the_run_in_which_a_simulator_fails_is_told():
    """Friction comes in the last of three runs."""
    simulator = joint_simulator()
    (recording,) = joint_recordings(Plant(friction=(0.0, 0.0, 0.3)), [0], runs=3)
    problem = problem_of(recording, simulator)
    blocks = problem.blocks
    speed = Regime("speed", "rad/s", blocks.inner(blocks.signals["velocity"]).abs())
    (found,) = locate(fit(simulator, problem).residual, channels_on(simulator, blocks), [speed], problem)
    worst, share = next(iter(found.runs.items()))
    assert worst == blocks.runs[2]
    assert share > 0.9
    assert abs(sum(found.runs.values()) - 1.0) < 1e-9
