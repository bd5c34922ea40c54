"""How much of an effect acts in each block where it grows or fades."""

import math
from dataclasses import replace

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from simgap.effects import DryFriction, effect_by_key
from simgap.effects.dry_friction import SHARE
from simgap.equations.trend import Trend, at_mean, trending, trends_of
from simgap.simulation import FittedEffect
from simgap.simulation.blocks import Blocks
from tests.pipeline.gap.problems import of_joint, problem_of
from tests.pipeline.gap.recordings import Plant, joint_recording, joint_simulator

(FRICTION,) = of_joint("viscous_friction")
LENGTH = 2.0  # s, of a block


def blocks_of(lengths: list[int]) -> Blocks:
    """Return blocks that hold nothing, some of each run, each run from its own zero of time."""
    run = torch.tensor([index for index, length in enumerate(lengths) for _ in range(length)])
    start = torch.tensor(
        [LENGTH * place for length in lengths for place in range(length)], dtype=torch.float64
    )
    return Blocks({}, run, tuple("abcd")[: len(lengths)], start, 0.01, 10, 200)


@given(st.lists(st.integers(1, 5), min_size=1, max_size=4))
def test_a_trend_through_a_recording_grows_by_the_same_in_every_block(lengths):
    blocks = blocks_of(lengths)
    growing, fading = trends_of(FRICTION, [blocks])[:2]
    middles = (torch.arange(len(blocks)) + 0.5) / len(blocks)
    torch.testing.assert_close(growing.share(blocks), middles.double())
    torch.testing.assert_close(fading.share(blocks), 1.0 - growing.share(blocks))


def test_a_trend_through_each_run_begins_anew_with_every_run():
    blocks = blocks_of([4, 2])
    growing = trends_of(FRICTION, [blocks])[4]
    assert growing.share(blocks).tolist() == [0.125, 0.375, 0.625, 0.875, 0.125, 0.375]
    assert growing.sentence == "grows through each run"


@given(st.lists(st.integers(1, 5), min_size=1, max_size=4), st.data())
def test_some_blocks_of_a_recording_have_the_shares_that_they_have_among_all(lengths, data):
    blocks = blocks_of(lengths)
    some = torch.tensor(sorted(data.draw(st.sets(st.integers(0, len(blocks) - 1), min_size=1))))
    for trend in trends_of(FRICTION, [blocks]):
        assert torch.equal(trend.share(blocks.take(some)), trend.share(blocks)[some])


def test_what_comes_to_an_end_has_changed_most_at_the_beginning():
    blocks = blocks_of([100])
    _, _, growing, fading = trends_of(FRICTION, [blocks])
    share = growing.share(blocks)
    assert torch.all(share.diff() > 0)
    assert torch.all(share.diff().diff() < 0)
    assert float(share[25]) == pytest.approx((1 - math.exp(-1.02)) / (1 - math.exp(-4.0)), rel=1e-6)
    torch.testing.assert_close(fading.share(blocks), 1.0 - share)


def test_a_machine_also_changes_in_runs_that_no_fit_sees():
    blocks = blocks_of([2, 3, 2])
    fitted, proving = blocks.of_runs(["b"]), blocks.of_runs(["a", "c"])
    together, apart = trends_of(FRICTION, [blocks]), trends_of(FRICTION, [fitted, proving])
    assert together == apart
    assert apart[0].share(fitted).tolist() == pytest.approx([2.5 / 7, 3.5 / 7, 4.5 / 7])


def test_one_run_has_one_clock():
    assert len(trends_of(FRICTION, [blocks_of([5])])) == 4


def test_what_begins_anew_does_so_whatever_the_clocks_of_the_runs_say():
    """Some logs begin at zero with every run, others go on through all of them."""
    blocks = blocks_of([3, 3])
    later = replace(blocks, start=blocks.start + 100.0 * blocks.run)
    for alike, moved in zip(trends_of(FRICTION, [blocks]), trends_of(FRICTION, [later]), strict=True):
        assert alike.begins_anew == moved.begins_anew
        assert alike.sentence == moved.sentence
        assert torch.equal(alike.share(blocks), moved.share(later))


def test_the_part_that_changes_is_another_effect_than_the_part_that_stays():
    changing = trending(FRICTION)
    assert changing is trending(FRICTION)
    assert (changing.key, FRICTION.key) == ("trend of viscous_friction", "viscous_friction")
    drive = effect_by_key("swerve", "viscous_friction@drive")
    assert trending(drive).key.partition("@")[2] == "drive"


@pytest.mark.parametrize(
    ("name", "does"), [("coulomb_friction", True), ("inertia_error", False), ("motor_lag", False)]
)
def test_friction_and_motors_drift_and_masses_and_lags_do_not(name, does):
    assert effect_by_key("joint", name).drifts is does


def test_rows_and_columns_hold_as_much_of_an_effect_as_acts_in_their_block():
    simulator = joint_simulator()
    problem = problem_of(joint_recording(Plant(viscous=0.3), runs=3), simulator)
    changing = simulator.with_effects((FittedEffect(trending(FRICTION), {"coefficient": 0.2}),))
    steady = simulator.with_effects((FittedEffect(FRICTION, {"coefficient": 0.2}),))
    growing = trends_of(FRICTION, [problem.blocks])[0]
    drifting = replace(problem, presence=growing)
    bare, whole = problem.residual(simulator), problem.residual(steady)
    share = growing.share(problem.blocks)[:, None, None]
    torch.testing.assert_close(drifting.residual(changing), bare + share * (whole - bare))
    columns = drifting.regressors(changing, trending(FRICTION))
    assert columns is not None
    torch.testing.assert_close(bare - 0.2 * columns[..., 0], drifting.residual(changing))


def test_dry_friction_that_grows_holds_an_axis_up_to_the_level_that_it_has():
    (dry,) = of_joint("coulomb_friction")
    simulator = joint_simulator()
    problem = problem_of(joint_recording(Plant(), runs=3), simulator)
    growing = trends_of(dry, [problem.blocks])[0]
    marked = replace(problem, blocks=growing.marked(problem.blocks), presence=growing)
    rows = marked.residual(simulator.with_effects((FittedEffect(trending(dry), {"level": 0.4}),)))
    for block, share in enumerate(growing.share(problem.blocks).tolist()):
        alone = replace(problem, blocks=problem.blocks.take(torch.tensor([block])))
        steady = simulator.with_effects((FittedEffect(dry, {"level": 0.4 * share}),))
        torch.testing.assert_close(rows[block], alone.residual(steady)[0])


@pytest.mark.parametrize("group", ["drive", "steer"])
def test_dry_friction_of_every_wheel_has_its_share(group):
    changing = trending(effect_by_key("swerve", f"coulomb_friction@{group}"))
    assert isinstance(changing, DryFriction)
    share = torch.tensor([[0.25], [1.0]], dtype=torch.float64)
    values = changing.values_now({SHARE: share}, {"level": 2.0})
    assert values["level"].tolist() == [[[0.5]], [[2.0]]]
    assert changing.values_now({}, {"level": 2.0}) == {"level": 2.0}


def test_half_of_what_grows_acts_on_average():
    simulator, changing = joint_simulator(), FittedEffect(trending(FRICTION), {"coefficient": 0.2})
    alone = at_mean(simulator.with_effects((changing,)), 0.5, (FRICTION,))
    assert [(f.effect, f.values["coefficient"]) for f in alone.effects] == [(FRICTION, 0.1)]
    beside = at_mean(
        simulator.with_effects((FittedEffect(FRICTION, {"coefficient": 0.1}), changing)), 0.5, (FRICTION,)
    )
    assert [f.values["coefficient"] for f in beside.effects] == [0.2]


def test_a_trend_takes_only_its_own_effect_away():
    simulator = joint_simulator().with_effects(
        (FittedEffect(FRICTION, {"coefficient": 0.1}), FittedEffect(trending(FRICTION), {"coefficient": 0.2}))
    )
    trend = Trend(trending(FRICTION).key, (0.0,), 1.0, None, grows=True, is_dry=False, begins_anew=False)
    assert [f.effect for f in trend.without(simulator).effects] == [FRICTION]
