"""The course of a competition, where its parts play no role."""

import numpy as np
import pytest
import torch

from simgap.effects import effect_by_key, effects_of
from simgap.gap import competition
from simgap.gap.ambiguity import Rivalry
from simgap.gap.candidate import Candidate
from simgap.gap.competition import Competition
from simgap.gap.fit import Fit, fit
from simgap.gap.look_alikes import substitute
from simgap.gap.name import usual_of
from simgap.gap.settings import Gap
from simgap.simulation import FittedEffect
from tests.pipeline.gap.problems import at_start, of_joint, problem_of
from tests.pipeline.gap.recordings import Plant, joint_recording, joint_simulator

USUAL = {"inertia_error", "motor_constant_error", "coulomb_friction", "viscous_friction"}


class Crowded(Competition):
    """A competition with room for so many effects, some of which are disowned; x may stay only beside b."""

    def __init__(self, room: int, contestants: str, doubtful: str) -> None:
        self.room, self.catalogue, self.doubtful = room, contestants, set(doubtful)
        self.inside: list[str] = []
        self.dropped: set[str] = set()
        self.run(contestants)

    def run(self, contestants: str) -> None:
        fresh = [each for each in contestants if each not in self.dropped | set(self.inside)]
        self.inside += fresh[: self.room - len(self.inside)]

    def has_room(self) -> bool:
        return len(self.inside) < self.room

    def disown(self) -> None:
        self.dropped |= self.doubtful & set(self.inside)
        self.inside = [each for each in self.inside if each not in self.dropped]

    def prune(self) -> None:
        if "b" not in self.inside and "x" in self.inside:
            self.dropped.add("x")
            self.inside.remove("x")


def test_what_cannot_stay_without_the_disowned_goes_too():
    competition = Crowded(3, "bx", "b")
    competition.catalogue = "bx"
    competition.conclude()
    assert competition.inside == []


def test_what_is_disowned_makes_room_for_what_it_kept_out():
    competition = Crowded(3, "abcdef", "bd")
    competition.conclude()
    assert competition.inside == ["a", "c", "e"]


def test_where_there_was_room_nothing_enters_again():
    competition = Crowded(4, "abc", "b")
    competition.catalogue = "abcz"
    competition.conclude()
    assert competition.inside == ["a", "c"]


def test_it_ends_where_all_are_disowned():
    competition = Crowded(1, "abc", "abc")
    competition.conclude()
    assert competition.inside == []


class Contested(Competition):
    """A competition in which two effects together predict so well, and the winner alone leaves more than noise."""

    def __init__(self, together: float, refusal: str = "", noisy: bool = False) -> None:
        self.problem, self.noisy = problem_of(joint_recording(Plant()), joint_simulator()), noisy
        self.judge = lambda effect, without, both: entry(effect.name, together, refusal=refusal)

    def leaves_more_than_noise(self, fitted: Fit | None = None) -> bool:
        return not self.noisy


def entry(name: str, score: float, share: float = 0.9, channel: int = 0, refusal: str = "") -> Candidate:
    fitted = fit(joint_simulator(), problem_of(joint_recording(Plant()), joint_simulator()))
    scores, no_interval = torch.tensor([score], dtype=torch.float64), (0.0, 0.0)
    numbers = (score, channel, share, share, 1.0, no_interval, 0.0, 1.0)
    return Candidate(effect_by_key("joint", name), fitted, scores, *numbers, refusal=refusal)


@pytest.mark.parametrize(
    ("together", "contest", "simpler", "first"),
    [
        (12.0, {}, {}, "coulomb_friction"),
        (9.0, {}, {}, "stribeck_friction"),
        (12.0, {"refusal": "not significant"}, {}, "stribeck_friction"),
        (12.0, {"noisy": True}, {}, "stribeck_friction"),
        (12.0, {}, {"share": 0.4}, "stribeck_friction"),
        (12.0, {}, {"channel": 1}, "stribeck_friction"),
    ],
    ids=["better together", "no better", "one is refused", "only noise is left", "too little", "elsewhere"],
)
def test_what_a_winner_had_to_explain_as_well_enters_before_it(
    together, contest, simpler, first, monkeypatch
):
    monkeypatch.setattr(competition, "extend", lambda fitted, effect, problem: fitted)
    winner, other = entry("stribeck_friction", 10.0), entry("coulomb_friction", 8.0, **simpler)
    assert Contested(together, **contest).first_of(winner, [winner, other]).effect.name == first


def test_what_is_found_wherever_a_fit_starts_is_not_asked():
    winner, other = entry("viscous_friction", 10.0), entry("coulomb_friction", 8.0)
    assert Contested(12.0).first_of(winner, [winner, other]) is winner
    assert Contested(12.0).first_of(None, []) is None


def test_of_what_begins_together_the_needless_goes():
    simulator = joint_simulator()
    problem = problem_of(joint_recording(Plant(friction=0.3)), simulator)
    competition = Competition(simulator, problem, Gap())
    competition.begin_with([effect for effect in competition.catalogue if effect.key in USUAL])
    assert competition.names() == {"coulomb_friction"}
    assert {candidate.effect.key for candidate in competition.rounds[0].candidates} == USUAL
    assert competition.dropped.keys() == USUAL - {"coulomb_friction"}


def test_what_any_joint_has_is_its_numbers_and_friction():
    assert {effect.key for effect in usual_of(list(effects_of("joint")))} == USUAL
    assert usual_of(list(effects_of("quadrotor"))) == []


@pytest.mark.slow
def test_two_look_alikes_are_exchanged_together():
    """A spring and friction by the square of speed stand where a weight and viscous friction belong."""
    plant = Plant(friction=0.3, viscous=0.2, other=lambda position, velocity: -0.8 * np.sin(position))
    problem = problem_of(joint_recording(plant, noise=0.1), joint_simulator())
    contest = Competition(joint_simulator(), problem, Gap())
    spring, square, weight, viscous, dry = of_joint(
        "linear_stiffness", "quadratic_friction", "gravity_load", "viscous_friction", "coulomb_friction"
    )
    taken = tuple(at_start(effect) for effect in (dry, spring, square))
    contest.become(fit(joint_simulator().with_effects(taken), problem))
    assert substitute(contest, [Rivalry(spring, (weight,), 0.6), Rivalry(square, (viscous,), 0.6)])
    assert contest.names() == {"coulomb_friction", "gravity_load", "viscous_friction"}
    assert contest.dropped.keys() >= {"linear_stiffness", "quadratic_friction"}
    assert not substitute(contest, [Rivalry(weight, (spring,), 0.6), Rivalry(viscous, (square,), 0.6)])


@pytest.mark.slow
def test_an_exchange_of_two_that_ends_worse_is_taken_back(monkeypatch):
    """What competes beside the exchanged ones may throw them out again, and more with them."""
    plant = Plant(viscous=0.2, other=lambda position, velocity: -0.8 * np.sin(position))
    problem = problem_of(joint_recording(plant, noise=0.1), joint_simulator())
    contest = Competition(joint_simulator(), problem, Gap())
    spring, square, weight, viscous = of_joint(
        "linear_stiffness", "quadratic_friction", "gravity_load", "viscous_friction"
    )
    contest.become(fit(joint_simulator().with_effects((at_start(spring), at_start(square))), problem))
    before = contest.current
    monkeypatch.setattr(contest, "exchange", lambda: contest.become(contest.base))
    assert not substitute(contest, [Rivalry(spring, (weight,), 0.6), Rivalry(square, (viscous,), 0.6)])
    assert contest.current is before
    assert (contest.dropped, contest.rounds) == ({}, [])


def test_a_refused_effect_becomes_what_it_comes_down_to():
    """Stribeck friction that fades at speeds far beyond those recorded is Coulomb friction."""
    problem = problem_of(joint_recording(Plant(friction=0.3)), joint_simulator())
    contest = Competition(joint_simulator(), problem, Gap())
    (stribeck,) = of_joint("stribeck_friction")
    wide = FittedEffect(stribeck, {"extra_level": 0.3, "velocity": 90.0})
    contest.become(fit(joint_simulator().with_effects((wide,)), problem))
    contest.prune()
    assert contest.names() == {"coulomb_friction"}
    assert contest.dropped == {"stribeck_friction": "comes down to coulomb friction here"}
    (found,) = contest.current.simulator.free
    assert found.values["level"] == pytest.approx(0.3, rel=0.05)
