"""Moves on two named effects at once: substitute both by rivals, or unite them in one effect."""

import itertools
from collections.abc import Sequence

from simgap.effects import Effect
from simgap.gap.ambiguity import Rivalry, is_as_good, is_beyond_chance
from simgap.gap.competition import Competition, Round, spoken
from simgap.gap.fit import Fit, fit
from simgap.gap.refit import extend, shrink

Exchange = tuple[tuple[Effect, Effect], ...]
"""Pairs of what goes and what comes."""


def substitute(contest: Competition, rivalries: Sequence[Rivalry]) -> bool:
    """Substitute two named effects at once by rivals if that predicts better; return whether it did.

    If two named effects are both look-alikes of the true ones, exchanging one of them gains little. The move is undone
    if the selection that follows does not end significantly better.
    """
    exchanged = [(pairs, _exchanged(contest, pairs)) for pairs in _exchanges_of_two(rivalries)]
    if not exchanged:
        return False
    pairs, best = max(exchanged, key=lambda each: float(contest.scores(each[1]).sum()))
    before, dropped, rounds = contest.current, dict(contest.dropped), list(contest.rounds)
    if not is_beyond_chance(contest.scores(best) - contest.scores(before)):
        return False
    for old, new in pairs:
        contest.dropped[old.key] = f"{spoken(new)} predicts better in its place"
    for _, new in pairs:
        contest.dropped.pop(new.key, None)
    contest.become(best)
    contest.starts.forget()
    contest.rounds.append(Round(tuple(contest.named()), contest.alone(pairs[-1][1])))
    contest.prune()
    contest.run(contest.catalogue)
    contest.exchange()
    if is_beyond_chance(contest.scores() - contest.scores(before)):
        return True
    contest.become(before)
    contest.dropped, contest.rounds = dropped, rounds
    return False


def unite(contest: Competition, rivalries: Sequence[Rivalry]) -> bool:
    """Replace two named effects by a common rival that predicts as well; return whether it did.

    Example: on a short travel, the sine of a weight looks like a spring and a cubic spring. One cause is likelier.
    """
    for first, second in itertools.combinations(rivalries, 2):
        shared = {effect.key for effect in first.rivals} & {effect.key for effect in second.rivals}
        for effect in (effect for effect in first.rivals if effect.key in shared):
            if _taken_for_both(contest, effect, first.winner, second.winner):
                return True
    return False


def _exchanges_of_two(rivalries: Sequence[Rivalry]) -> list[Exchange]:
    """Return every way to put rivals in the place of two named effects."""
    return [
        ((first.winner, one), (second.winner, other))
        for first, second in itertools.combinations(rivalries, 2)
        for one, other in itertools.product(first.rivals, second.rivals)
        if one.key != other.key
    ]


def _exchanged(contest: Competition, pairs: Exchange) -> Fit:
    """Return a fit in which the second of each pair stands in the place of the first."""
    problem, fitted = contest.problem, contest.current
    for old, new in pairs:
        without = shrink(fitted, old, problem, contest.known.get(old.key))
        fitted = extend(without, new, problem, new.starts_in(problem.blocks.signals))
    return fit(fitted.simulator, problem)


def _taken_for_both(contest: Competition, effect: Effect, first: Effect, second: Effect) -> bool:
    """Put an effect in the place of two where it is not refused and predicts as well; return whether it did."""
    problem = contest.problem
    without = shrink(contest.without(first), second, problem, contest.known.get(second.key))
    united = fit(extend(without, effect, problem, contest.starts.of(effect)).simulator, problem)
    candidate = contest.judge(effect, without, united)
    if candidate.refusal or not is_as_good(contest.scores(united), contest.scores()):
        return False
    contest.rounds.append(Round((candidate,), candidate))
    contest.dropped |= dict.fromkeys((first.key, second.key), f"{spoken(effect)} alone explains as much")
    contest.dropped.pop(effect.key, None)
    contest.become(united)
    contest.prune()
    return True
