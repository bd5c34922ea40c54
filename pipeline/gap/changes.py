"""Changes: effects that begin or end in the middle of a recording, or that act in some runs only.

Every boundary between two blocks is a place where an effect may begin or end. Which of them are worth a fit follows
from the linearisation about a hypothesis, as with sets of effects. The place is then moved to where the rows are met
best.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
import torch

from simgap.equations.presence import Presence, beginning, ending
from simgap.equations.trend import Trend
from simgap.gap.hypothesis import Hypothesis
from simgap.gap.neighbours import Neighbours
from simgap.gap.partly import Partly
from simgap.gap.reading import Reading
from simgap.simulation import FittedEffect
from simgap.simulation.blocks import Blocks

_CHANGED = 0.05
"""Odds that something on a machine changes while it is recorded: it breaks, or a person repairs or loads it."""
_BEGINS, _ENDS, _SCATTERED = 0.5, 0.25, 0.25
"""Shares of that: an effect that begins, one that ends, and one that comes and goes between runs."""
_BETWEEN_RUNS = 0.5
"""Share of beginnings and ends that lie between two runs, where people touch a machine, rather than within one."""
_MOST_PLACES = 24
"""Places within runs that are tried, drawn evenly, before the best one is refined."""
_WEIGHED = 8
"""Changes whose promise is worked out in full beside each hypothesis."""
_FEWEST_BLOCKS = 4
"""Of a recording: with less, the part without the effect shows no law by itself."""
_FEWEST_RUNS = 3
"""From which on an effect may come and go between runs."""
_PAIRED = 6
"""Effects of which pairs are tried in each place: neither alone may meet the rows there."""
_TOGETHER = 0.5
"""Probability that a change brings one more effect: a crash bends more than one part."""


@dataclass(frozen=True)
class Change:
    """An effect that acts in a part of the recording.

    Attributes:
        presence: of it, and of those that act where it does.
        effects: of the hypothesis that they belong to, with values to start a fit from.
        promise: the score that the linearisation gives it.
    """

    presence: Presence
    effects: tuple[FittedEffect, ...]
    promise: float


def changes(near: Neighbours) -> list[Change]:
    """Return the most promising changes beside a hypothesis, best first.

    Beside a hypothesis with a change already, these are the effects that the same change may have brought, too; beside
    one with a trend there are none.

    Args:
        near: the linearisation about it.
    """
    blocks, presence = near.centre.reading.problem.blocks, near.centre.reading.presence
    if len(blocks) < _FEWEST_BLOCKS or isinstance(presence, Trend):
        return []
    tried: list[tuple[Presence, tuple[str, ...]]]
    if presence is not None:
        others = [key for key in near.changeable if key not in presence.keys]
        tried = [(presence, (key,)) for key in _likeliest_in(near, presence, others, blocks)[:_WEIGHED]]
    else:
        alone = [entry for key in near.changeable for entry in _likeliest(near, key, blocks)]
        alone.sort(key=lambda entry: -entry[0])
        tried = [(place, (key,)) for _, key, place in alone[:_WEIGHED]]
        for place in dict.fromkeys(place for place, _ in tried):
            together = _likeliest_in(near, place, near.changeable, blocks)[:_PAIRED]
            tried += [(place, pair) for pair in combinations(together, 2)]
    weighed = [_weighed(near, keys, place, blocks) for place, keys in tried]
    return sorted(weighed, key=lambda change: -change.promise)


def changed_reading(reading: Reading, presence: Presence) -> Reading:
    """Return a reading in which effects act in a part of the recording.

    Of the runs that were held out, those prove the answer in which they act: the simulator has them throughout.
    """
    prepared = reading.prepared
    problem = replace(prepared.problem, presence=presence)
    proven = torch.nonzero(presence.acts(prepared.proving)).squeeze(1)
    held_out = prepared.held_out and len(proven) > 0
    proving = prepared.proving.take(proven) if held_out else problem.blocks.take(problem.present)
    prepared = replace(prepared, problem=problem, proving=proving, held_out=held_out)
    odds = reading.odds * math.exp(_log_odds(presence, problem.blocks))
    return replace(reading, prepared=prepared, odds=odds, presence=presence, throughout=reading)


def refined(found: Hypothesis) -> Presence:
    """Return the presence of a change moved to where the rows of its hypothesis are met best.

    Only what begins or ends within a run is moved: all places between runs were tried. The values stay as they are.
    """
    problem, simulator = found.reading.problem, found.fit.simulator
    presence = problem.presence
    assert isinstance(presence, Presence)
    if presence.since is None and presence.until is None:
        return presence
    always = replace(problem, presence=None)
    costs = [
        (always.residual(each) / found.fit.scale).square().sum((1, 2))
        for each in (simulator, presence.without(simulator))
    ]
    saved = (costs[1] - costs[0]).cumsum(0)
    places = _within_runs(problem.blocks)
    before = saved[torch.tensor(places) - 1]
    if presence.since is not None:
        moved = beginning(problem.blocks, places[int(before.argmin())])
    else:
        moved = ending(problem.blocks, places[int(before.argmax())])
    return replace(moved, keys=presence.keys)


def _weighed(near: Neighbours, keys: tuple[str, ...], place: Presence, blocks: Blocks) -> Change:
    """Return the change by which effects act in a place, too, with what the linearisation promises of it."""
    before, presence = near.centre.reading.presence, place.joined_by(*keys)
    odds = _log_odds(presence, blocks) - (_log_odds(before, blocks) if isinstance(before, Presence) else 0.0)
    promise = Partly(near).promise(keys, presence.acts(blocks)[near.part].numpy()) + odds
    return Change(presence, near.starts_with(keys), promise)


def _likeliest_in(near: Neighbours, place: Presence, keys: Sequence[str], blocks: Blocks) -> list[str]:
    """Return effects in the order of what each saves alone where it acts in a place."""
    acting = place.acts(blocks)[near.part].numpy()[None]
    return sorted(keys, key=lambda key: -float(Partly(near).saved(key, acting).max()))


def _likeliest(near: Neighbours, key: str, blocks: Blocks) -> list[tuple[float, str, Presence]]:
    """Return where an effect most likely acts, by each weighting of the rows, and a rough score."""
    tried = [*_beginnings_and_ends(blocks), *_scattered(near, key, blocks)]
    acting = np.stack([place.acts(blocks)[near.part].numpy() for place in tried])
    odds = np.array([_log_odds(place, blocks) for place in tried])
    scores = Partly(near).saved(key, acting) + odds
    best = {int(score.argmax()) for score in scores}
    return [(float(scores[:, place].max()), key, tried[place]) for place in sorted(best)]


def _beginnings_and_ends(blocks: Blocks) -> list[Presence]:
    within = _within_runs(blocks)
    drawn = np.linspace(0, len(within) - 1, min(len(within), _MOST_PLACES)).round().astype(int)
    places = [*_between_runs(blocks), *(within[index] for index in drawn)]
    return [make(blocks, place) for place in places for make in (beginning, ending)]


def _scattered(near: Neighbours, key: str, blocks: Blocks) -> list[Presence]:
    """Return the runs in which an effect acts, where it comes and goes: what the runs show has one widest gap."""
    runs = torch.unique(blocks.run).tolist()
    if len(runs) < _FEWEST_RUNS:
        return []
    of_run = blocks.run[near.part].numpy()
    shown = Partly(near).sizes(key, np.stack([of_run == run for run in runs]))
    order = np.argsort(shown)[::-1]
    last = int(np.argmin(np.diff(shown[order])))
    chosen = sorted(runs[place] for place in order[: last + 1])
    if chosen in (runs[: len(chosen)], runs[-len(chosen) :]):
        return []  # it begins or ends between two runs
    return [Presence((), tuple(blocks.runs[run] for run in chosen))]


def _log_odds(presence: Presence, blocks: Blocks) -> float:
    """Return the log prior odds of a change at one of the places that a recording has."""
    return _log_odds_of_place(presence, blocks) + max(len(presence.keys) - 1, 0) * math.log(_TOGETHER)


def _log_odds_of_place(presence: Presence, blocks: Blocks) -> float:
    runs = len(torch.unique(blocks.run))
    between, within = runs - 1, len(blocks) - runs
    if presence.since is not None or presence.until is not None:
        share = _BEGINS if presence.since is not None else _ENDS
        return math.log(_CHANGED * share * (1.0 - _BETWEEN_RUNS * (between > 0)) / within)
    chosen, every = (torch.unique(part).tolist() for part in (blocks.run[presence.acts(blocks)], blocks.run))
    part = _BETWEEN_RUNS if within else 1.0
    if chosen == every[-len(chosen) :]:
        return math.log(_CHANGED * _BEGINS * part / between)
    if chosen == every[: len(chosen)]:
        return math.log(_CHANGED * _ENDS * part / between)
    return math.log(_CHANGED * _SCATTERED) - runs * math.log(2.0)


def _between_runs(blocks: Blocks) -> list[int]:
    return (torch.nonzero(blocks.run.diff()).squeeze(1) + 1).tolist()


def _within_runs(blocks: Blocks) -> list[int]:
    return (torch.nonzero(blocks.run.diff() == 0).squeeze(1) + 1).tolist()
