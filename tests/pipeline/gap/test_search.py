"""The search keeps what it has seen, ends in time, and can be interrupted."""

import functools

import pytest

from simgap.diagnosis.diagnose import diagnose
from simgap.effects import effect_by_key
from simgap.equations.presence import Presence
from simgap.gap import search as searched
from simgap.gap.hypothesis import Hypothesis
from simgap.gap.name import name
from simgap.gap.posterior import posterior_of
from simgap.gap.reading import Reading, readings_of
from simgap.gap.search import Search
from simgap.gap.settings import Gap
from simgap.simulation import FittedEffect
from tests.pipeline.gap.recordings import Plant, joint_recordings, joint_simulator

FEW = ["coulomb_friction", "viscous_friction", "constant_load", "command_delay"]


@functools.cache
def recorded():
    return joint_recordings(Plant(friction=0.3, viscous=0.04), [0], runs=4, duration=4.0)[0]


@functools.cache
def readings() -> list[Reading]:
    return readings_of(recorded(), joint_simulator(), Gap(effects=FEW))


class Noted(Search):
    """A search that notes everything that it would keep."""

    def __init__(self, *given) -> None:
        self.weighed: list[Hypothesis] = []
        super().__init__(*given)

    def _keep(self, hypothesis) -> None:
        super()._keep(hypothesis)
        self.weighed.append(hypothesis)


@functools.cache
def ended() -> tuple[Noted, bool]:
    search = Noted(readings(), Gap(effects=FEW))
    return search, search.run(8, 600.0)


def test_it_comes_to_an_end_with_what_is_there():
    search, complete = ended()
    assert complete
    assert search.ranked[0].names == {"coulomb_friction", "viscous_friction"}


def test_what_may_be_missing_is_looked_for_under_every_timing():
    """What one timing explains may be what another one hides."""
    search, _ = ended()
    assert {(reading.timing, frozenset()) for reading in readings()} <= search.expanded


def test_the_answer_is_never_below_the_best_that_was_visited():
    search, _ = ended()
    best = max(hypothesis.score for hypothesis in search.weighed)
    assert search.ranked[0].score == best
    assert posterior_of(list(search.visited.values())).best.score == best


def test_what_is_visited_twice_keeps_its_better_score():
    search, _ = ended()
    assert len(search.weighed) > len(search.visited)
    for hypothesis in search.weighed:
        assert search.visited[hypothesis.place].score >= hypothesis.score
    assert {hypothesis.place for hypothesis in search.weighed} == set(search.visited)


def test_everything_within_the_window_of_the_best_was_followed():
    search, _ = ended()
    near = [h for h in search.ranked if h.score > search.ranked[0].score - 3.0]
    assert {h.place for h in near} <= search.expanded
    assert any(h.names == frozenset() for h in search.visited.values())


def test_no_hypothesis_has_more_effects_than_allowed():
    search = Search(readings(), Gap(effects=FEW))
    search.run(1, 600.0)
    singles = [h for h in search.ranked if len(h.keys) == 1]
    assert singles
    assert search.ranked[0].keys <= {"coulomb_friction", "viscous_friction"}


def test_without_time_there_is_an_answer_that_is_marked():
    search = Search(readings(), Gap(effects=FEW))
    assert not search.run(8, 0.0)
    assert search.ranked[0].names == frozenset()
    naming = name(readings(), Gap(effects=FEW, budget=1e-9))
    assert not naming.complete
    assert naming.posterior.weights


@pytest.mark.slow
def test_a_diagnosis_without_time_says_so():
    found = diagnose(recorded(), joint_simulator(), Gap(effects=FEW, budget=1e-9, resamples=50, horizon=0.05))
    assert found.naming.named == ()
    assert found.verdict == "unexplained"
    assert any("the search was ended before it was complete" in warning for warning in found.warnings)


@pytest.mark.parametrize("after", [3, 8, 15])
def test_a_person_who_interrupts_gets_the_answer_so_far(monkeypatch, after):
    weigh, calls, seen = searched.weigh, 0, []

    def interrupted(fitted, reading) -> Hypothesis:
        nonlocal calls
        calls += 1
        if calls > after:
            raise KeyboardInterrupt
        seen.append(weigh(fitted, reading))
        return seen[-1]

    monkeypatch.setattr(searched, "weigh", interrupted)
    naming = name(readings(), Gap(effects=FEW))
    assert not naming.complete
    assert naming.best.score == max(hypothesis.score for hypothesis in seen)


def test_the_same_search_finds_the_same():
    first, second = (Search(readings(), Gap(effects=FEW)) for _ in range(2))
    assert first.run(8, 600.0)
    assert second.run(8, 600.0)
    assert [(h.place, h.score) for h in first.ranked] == [(h.place, h.score) for h in second.ranked]


@pytest.mark.parametrize(
    ("change", "grows"), [({"since": 1.0}, True), ({}, True), ({"until": 1.0}, False)], ids=str
)
def test_what_begins_may_grow_and_what_ends_may_fade(monkeypatch, change, grows):
    """In the last run, too, what acts until a time within it ends."""
    search, reading = Search(readings(), Gap(effects=FEW)), readings()[0]
    last = reading.problem.blocks.runs[-1]
    presence = Presence(("viscous_friction",), (last,), **change)
    tried = []
    monkeypatch.setattr(search, "_drifting", lambda _, trend, *rest: tried.append(trend))
    centre = search.visited[reading.timing, frozenset()]
    search._slowly(centre, presence)
    assert tried
    assert all(trend.grows == grows for trend in tried)


def test_what_is_known_of_an_effect_is_corrected_and_not_doubled():
    known = FittedEffect(effect_by_key("joint", "coulomb_friction"), {"level": 0.2}, known=True)
    settings = Gap(effects=FEW)
    search = Search(readings_of(recorded(), joint_simulator(known), settings), settings)
    search.run(8, 600.0)
    for hypothesis in search.ranked:
        keys = [fitted.effect.key for fitted in hypothesis.fit.simulator.effects]
        assert keys.count("coulomb_friction") == 1, keys
    (friction,) = (f for f in search.ranked[0].fit.simulator.effects if f.effect.key == "coulomb_friction")
    assert friction.values["level"] == pytest.approx(0.3, rel=0.05)
