"""The search for hypotheses: add, drop, swap, merge, split and other timing, with everything visited kept.

The best hypothesis that is not expanded yet is expanded next, as long as its score lies within Occam's window of the
best. So several lines of thought stay alive, nothing is dropped for good, and the answer is never below the best that
was visited.
Source of the window: Madigan & Raftery 1994, Model selection and accounting for model uncertainty (JASA 89).
"""

import math
import time
from collections.abc import Sequence

from simgap.effects import Effect, look_alikes_of
from simgap.equations.fit import Fit, finished, fit, jacobian_of
from simgap.equations.presence import Presence
from simgap.equations.refit import extend, remove, shrink
from simgap.equations.trend import Trend, at_mean, trending, trends_of
from simgap.gap.changes import changed_reading, changes, refined
from simgap.gap.hypothesis import Hypothesis, idle_in, weigh
from simgap.gap.latent_inputs import driven_again, driven_readings
from simgap.gap.neighbours import Neighbours, Proposal
from simgap.gap.reading import Reading, Timing
from simgap.gap.settings import Gap
from simgap.gap.trends import trending_reading, trends
from simgap.simulation import FittedEffect, Simulator

_WINDOW = 3.0
"""Of log odds: a hypothesis twenty times less probable than the best is not followed further."""
_MISSED = 10.0
"""Of log odds that a linearisation may miss: so much less promising sets are fitted, too."""
_PROPOSALS, _MOST_PROPOSALS = 6, 18
"""Neighbours by two effects that are fitted for each hypothesis: that keep their promise, and in all."""
_FIRST_STEPS = 2
"""Of a proposal's fit, before it goes on only within reach of the best: the first follows from the linearisation, the
second shows whether it keeps its promise."""
_CHANGES = 2
"""Effects in a part of the recording, and trends, that are fitted for each hypothesis and keep their promise."""

Place = tuple[Timing, frozenset[str]]


def _with(reading: Reading, free: Sequence[FittedEffect]) -> Simulator:
    """Return the nominal simulator of a reading with effects to be fitted, in the place of what is known of them."""
    keys = {fitted.effect.key for fitted in free}
    known = (fitted for fitted in reading.nominal.known if fitted.effect.key not in keys)
    return reading.nominal.with_effects((*known, *free))


class _TimeIsOver(Exception):
    """The search has used up its time."""


def _is_outdone(hypothesis: Hypothesis, others: Sequence[Hypothesis]) -> bool:
    """Whether some of its effects alone score higher: what was added to them gains nothing (Madigan & Raftery 1994)."""
    return any(
        other.keys < hypothesis.keys
        and other.reading.timing == hypothesis.reading.timing
        and other.score > hypothesis.score
        for other in others
    )


class Search:
    """All hypotheses visited for one recording."""

    def __init__(self, readings: Sequence[Reading], settings: Gap) -> None:
        """Begin with the hypotheses that nothing is missing.

        Args:
            readings: the recording under every timing of its commands.
            settings: of the gap engine.
        """
        self.readings, self.settings = list(readings), settings
        self.bases: dict[Timing, Fit] = {}
        self.changed: dict[tuple[Timing, Presence | Trend], Reading] = {}
        self.end = math.inf
        self.visited: dict[Place, Hypothesis] = {}
        self.expanded: set[Place] = set()
        for reading in readings:
            self.bases[reading.timing] = fit(reading.nominal, reading.problem)
            self._visit(self.bases[reading.timing], reading)

    @property
    def ranked(self) -> list[Hypothesis]:
        """Every visited hypothesis, the most probable first."""
        return sorted(self.visited.values(), key=lambda hypothesis: -hypothesis.score)

    def run(self, most_effects: int, seconds: float) -> bool:
        """Expand hypotheses until none within the window is left; return whether the search came to that end.

        It ends before when the time is over, or when the person interrupts it: what was visited stays.
        """
        self.end = time.monotonic() + seconds
        try:
            for first in list(self.visited.values()):
                self._expand(first, most_effects)
            while (following := self._next()) is not None:
                self._expand(following, most_effects)
        except (KeyboardInterrupt, _TimeIsOver):
            return False
        return True

    def at_mean(self, found: Hypothesis) -> Hypothesis:
        """Return a hypothesis with what grows or fades in it at its mean: a simulator does not change."""
        if not isinstance(found.reading.presence, Trend):
            return found
        reading = self._timed(found.reading, None)
        share = float(found.reading.problem.share.mean())
        simulator, problem = at_mean(found.fit.simulator, share, reading.catalogue), reading.problem
        residual = problem.residual(simulator)
        scale, _ = problem.weigh(residual, simulator)
        return weigh(
            finished(simulator, residual, jacobian_of(simulator, problem, residual), scale, problem), reading
        )

    def _next(self) -> Hypothesis | None:
        ranked = self.ranked
        least = ranked[0].score - _WINDOW
        near = [hypothesis for hypothesis in ranked if hypothesis.score >= least]
        waiting = (h for h in near if h.place not in self.expanded and not _is_outdone(h, near))
        return next(waiting, None)

    def _expand(self, centre: Hypothesis, most_effects: int) -> None:
        self.expanded.add(centre.place)
        reading = centre.reading
        polished = self._visit(fit(centre.fit.simulator, reading.problem), reading)
        centre = max((centre, polished), key=lambda hypothesis: hypothesis.score)
        plain = not reading.driver and reading.presence is None
        if not reading.driver:
            self._retime(centre)
        if plain and reading.catalogue:
            self._drive(centre)
        self._throughout(centre)
        for key in centre.doubtful:
            self._without(centre, key)
            self._exchange(centre, key)
        added = [self._added(centre, e) for e in reading.catalogue if e.key not in centre.keys]
        smaller = {key: (reading.timing, centre.keys - {key}) for key in centre.doubtful}
        dropped = {key: self.visited[place] for key, place in smaller.items() if place in self.visited}
        near = Neighbours(centre, added, dropped)
        if not reading.driver:
            self._change(near)
            self._trend(near)
        fitted_sets = {keys for timing, keys in self.visited if timing == reading.timing}
        least = self.ranked[0].score - _WINDOW - _MISSED
        kept = 0
        for proposal in near.best(_MOST_PROPOSALS, fitted_sets):
            if len(proposal.keys) <= most_effects and proposal.promise > least and kept < _PROPOSALS:
                kept += self._proposed(reading, proposal, least).score > proposal.promise - _MISSED

    def _proposed(self, reading: Reading, proposal: Proposal, least: float) -> Hypothesis:
        """Visit a proposed set of effects; what is far from its promise after the first steps is fitted no further."""
        found = self._visit(
            fit(_with(reading, proposal.effects), reading.problem, most_steps=_FIRST_STEPS), reading
        )
        if found.score < least:
            return found
        return self._visit(fit(found.fit.simulator, reading.problem), reading)

    def _retime(self, centre: Hypothesis) -> None:
        """Visit the same effects under every other timing of the commands, and there those that it does not explain."""
        for timed in self.readings:
            other = self._with_presence(timed, centre.reading.presence)
            if (other.timing, centre.keys) not in self.visited:
                found = self._visit(fit(_with(other, centre.fit.simulator.free), other.problem), other)
                for key in found.doubtful - found.names:
                    self._without(found, key)

    def _without(self, centre: Hypothesis, key: str) -> None:
        """Visit a hypothesis without one of its effects."""
        reading = centre.reading
        partly = reading.presence is not None and key in reading.presence.keys
        if not partly and (reading.timing, centre.keys - {key}) not in self.visited:
            effect = next(f.effect for f in centre.fit.simulator.free if f.effect.key == key)
            self._visit(shrink(centre.fit, effect, reading.problem, reading.known(effect)), reading)

    def _exchange(self, centre: Hypothesis, key: str) -> None:
        """Visit a hypothesis with each look-alike in the place of one of its effects.

        Beside the effect that it stands in for a look-alike does nothing, so that no linearisation there shows it.
        """
        reading = centre.reading
        effect = next(f.effect for f in centre.fit.simulator.free if f.effect.key == key)
        if isinstance(reading.presence, Presence) and key in reading.presence.keys:
            self._exchange_in_part(centre, effect, reading.presence)
        smaller = self.visited.get((reading.timing, centre.keys - {key}))
        if smaller is None:
            return
        for other in look_alikes_of(effect):
            place = reading.timing, smaller.keys | {other.key}
            if other in reading.catalogue and other.key not in centre.keys and place not in self.visited:
                self._added(smaller, other)

    def _exchange_in_part(self, centre: Hypothesis, effect: Effect, presence: Presence) -> None:
        """Visit a hypothesis with each look-alike in the place of an effect that acts in a part of the recording."""
        others = tuple(f for f in centre.fit.simulator.free if f.effect.key != effect.key)
        for other in look_alikes_of(effect):
            unknown = centre.reading.known(other) is None
            if unknown and other in centre.reading.catalogue and other.key not in centre.keys:
                reading = self._timed(centre.reading, presence.without_key(effect.key).joined_by(other.key))
                if (reading.timing, centre.keys - {effect.key} | {other.key}) not in self.visited:
                    smaller = fit(_with(reading, others), reading.problem)
                    self._visit(extend(smaller, other, reading.problem, reading.starts), reading)

    def _drive(self, centre: Hypothesis) -> None:
        """Visit the same effects with one more whose driver was not recorded and is estimated."""
        for reading, effect in driven_readings(centre, self.settings):
            self.bases.setdefault(reading.timing, fit(reading.nominal, reading.problem))
            start = _with(reading, (*centre.fit.simulator.free, FittedEffect(effect, effect.defaults())))
            found = self._visit(fit(start, reading.problem), reading)
            if effect.key in found.keys and found.score > centre.score - _MISSED:
                again = driven_again(found, centre.reading)
                self._visit(fit(_with(again, found.fit.simulator.free), again.problem), again)

    def _change(self, near: Neighbours) -> None:
        """Visit the same effects with one of them, or one more, in a part of the recording only.

        Beside a change, these join it.
        """
        least = self.ranked[0].score - _WINDOW
        kept = 0
        for change in changes(near):
            if change.promise > least and kept < _CHANGES:
                found = self._changed(near.centre, change.presence, change.effects)
                if found.score > change.promise - _MISSED:
                    kept += 1
                    self._changed(near.centre, refined(found), found.fit.simulator.free)

    def _trend(self, near: Neighbours) -> None:
        """Visit the same effects with one that grows or fades beside them."""
        centre = near.centre
        if centre.reading.presence is not None:
            return
        least = self.ranked[0].score - _WINDOW
        for each in [found for found in trends(near) if found.promise > least][:_CHANGES]:
            self._changed(centre, each.trend, each.effects)

    def _throughout(self, centre: Hypothesis) -> None:
        """Visit a hypothesis with a change without it, and with each of several effects of the change throughout."""
        presence = centre.reading.presence
        if isinstance(presence, Trend):
            self._steady(centre)
            self._exchange_trend(centre, presence)
        if not isinstance(presence, Presence):
            return
        self._slowly(centre, presence)
        several = presence.keys if len(presence.keys) > 1 else ()
        for part in [None, *map(presence.without_key, several)]:
            reading = self._timed(centre.reading, part)
            if (reading.timing, centre.keys) not in self.visited:
                self._visit(fit(_with(reading, centre.fit.simulator.free), reading.problem), reading)

    def _steady(self, centre: Hypothesis) -> None:
        """Visit a hypothesis without what grows or fades in it."""
        reading = self._timed(centre.reading, None)
        staying = tuple(f for f in centre.fit.simulator.free if not f.effect.trends)
        if (reading.timing, frozenset(f.effect.key for f in staying)) not in self.visited:
            self._visit(fit(_with(reading, staying), reading.problem), reading)

    def _slowly(self, centre: Hypothesis, presence: Presence) -> None:
        """Visit a hypothesis with a change with each effect that may drift in its place, growing or fading."""
        recorded = self._timed(centre.reading, None).prepared.recorded
        free = centre.fit.simulator.free
        others = tuple(f for f in free if f.effect.key not in presence.keys)
        begins = presence.until is None and presence.runs[-1] == recorded[0].runs[-1]
        for effect in (each for each in centre.reading.catalogue if each.drifts):
            changed = next((f for f in free if f.effect.key == effect.key and f not in others), None)
            for trend in trends_of(effect, recorded):
                if trend.is_straight and trend.grows == begins:
                    self._drifting(centre.reading, trend, others, effect, changed)

    def _drifting(
        self,
        reading: Reading,
        trend: Trend,
        others: Sequence[FittedEffect],
        effect: Effect,
        start: FittedEffect | None = None,
    ) -> None:
        """Visit other effects with one that grows or fades, fitted from known values or from where its fits begin."""
        reading = self._timed(reading, trend)
        if (reading.timing, frozenset(f.effect.key for f in others) | {trend.key}) in self.visited:
            return
        if start is not None:
            simulator = _with(reading, (*others, FittedEffect(trending(effect), start.values)))
            self._visit(fit(simulator, reading.problem), reading)
        else:
            base = fit(_with(reading, others), reading.problem)
            self._visit(extend(base, trending(effect), reading.problem, reading.starts), reading)

    def _exchange_trend(self, centre: Hypothesis, trend: Trend) -> None:
        """Visit a hypothesis with each other effect that may drift in the place of the one that does, which stays."""
        staying = self.at_mean(centre).fit.simulator.free
        for effect in (each for each in centre.reading.catalogue if each.drifts):
            if trending(effect).key != trend.key:
                self._drifting(centre.reading, trend.of(effect), staying, effect)

    def _changed(
        self, centre: Hypothesis, presence: Presence | Trend, effects: Sequence[FittedEffect]
    ) -> Hypothesis:
        reading = self._timed(centre.reading, presence)
        return self._visit(fit(_with(reading, effects), reading.problem), reading)

    def _timed(self, reading: Reading, presence: Presence | Trend | None) -> Reading:
        """Return a reading with the timing of another one, in which some effects may act in a part, or change."""
        timed = next(each for each in self.readings if each.held == reading.held)
        return self._with_presence(timed, presence)

    def _with_presence(self, reading: Reading, presence: Presence | Trend | None) -> Reading:
        """Return a reading in which some effects act in a part of the recording, or change, the same one every time."""
        if presence is None:
            return reading
        place = reading.timing, presence
        if place not in self.changed:
            if isinstance(presence, Trend):
                self.changed[place] = trending_reading(reading, presence)
            else:
                self.changed[place] = changed_reading(reading, presence)
            self.bases[self.changed[place].timing] = self.bases[reading.timing]
        return self.changed[place]

    def _added(self, centre: Hypothesis, effect: Effect) -> Hypothesis:
        reading = centre.reading
        return self._visit(extend(centre.fit, effect, reading.problem, reading.starts), reading)

    def _visit(self, fitted: Fit, reading: Reading) -> Hypothesis:
        """Weigh a fit and keep it where it is the best of its effects; end the search where its time is over.

        Where some effects of a fit do nothing, the hypothesis without them is what is kept.
        """
        hypothesis = weigh(fitted, reading)
        idle = idle_in(fitted, reading)
        for each in idle:
            fitted = remove(fitted, each.effect, reading.problem, reading.known(each.effect))
        self._keep(weigh(fitted, reading) if idle else hypothesis)
        if time.monotonic() > self.end:
            raise _TimeIsOver
        return hypothesis

    def _keep(self, hypothesis: Hypothesis) -> None:
        presence = hypothesis.reading.presence
        if presence is not None and not hypothesis.keys.issuperset(presence.keys):
            return
        before = self.visited.get(hypothesis.place)
        if before is None or hypothesis.score > before.score:
            self.visited[hypothesis.place] = hypothesis
