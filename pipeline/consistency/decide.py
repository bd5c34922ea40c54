"""The decision: does a recording contradict itself, and which transformation makes the contradiction vanish?

The score of an explanation is the log likelihood of all agreements plus the logarithm of its odds. Nothing is said
unless an explanation beats the recording as it stands by `CLEAR`, or no explanation helps and two exact series differ
beyond doubt. What an explanation is worth below that stays as a doubt: names hold only if none of them is true.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from simgap.consistency.checked import Checked
from simgap.consistency.families import Agreements, Family, Platform, families_of
from simgap.consistency.faults import faults_of
from simgap.consistency.samples import Samples, samples_of, thinner
from simgap.consistency.tell import State, support_of, told, unexplained
from simgap.consistency.transformation import Transformation
from simgap.recordings.cleaning.clean import mended
from simgap.recordings.contradiction import Contradiction
from simgap.recordings.recording import Recording

CLEAR = 3.0
"""Difference of scores that counts: odds of twenty to one (Occam's window of `gap/search.py`)."""

_STEPS = 3  # faults of one recording
_FEW = 60  # transformations, of which every two can be tried
_PAIRED = 4  # of more, those that are tried with each other one, the most promising first


def contradictions(recording: Recording, platform: Platform | None = None) -> list[Contradiction]:
    """Return all in a recording that contradicts itself or the platform, so that nothing can be named; see `check`."""
    return list(check(recording, platform).contradictions)


def check(recording: Recording, platform: Platform | None = None) -> Checked:
    """Return what contradicts itself or the platform in a recording.

    Args:
        recording: raw, or cleaned.
        platform: what is known of the machine; without it, only what needs none is checked.
    """
    if not recording.cleaned:
        recording = mended(recording)
    samples = samples_of(recording)
    families = families_of(samples, platform)
    state = _state(samples, families)
    if not state.opposed:
        return Checked()
    names = recording.runs
    chosen = _concerned(recording, families, names)
    found = _checked(recording, chosen, families, platform)
    if found.contradictions or len(chosen) == len(names):
        return found
    # What the other runs say besides may decide what these leave open.
    whole = _checked(recording, names, families, platform)
    return whole if whole.contradictions or whole.doubt > found.doubt else found


def _checked(
    recording: Recording, runs: list[str], families: Sequence[Family], platform: Platform | None
) -> Checked:
    """Return what is found in some of the runs, in which something is opposed."""
    sliding = recording.units.get("position") == "m"
    state = _state(thinner(samples_of(recording, runs)), families)
    found = _explained(state, families, platform, sliding)
    if found:
        return Checked(tuple(replace(each, runs=tuple(runs)) for each in found))
    return _doubt(state, families, faults_of(state.samples, platform, sliding), tuple(runs))


def _concerned(recording: Recording, families: Sequence[Family], names: list[str]) -> list[str]:
    """Return the runs in which something is opposed; all of them where no run shows it alone."""
    if len(names) == 1:
        return names
    chosen = [name for name in names if _state(samples_of(recording, [name]), families).opposed]
    return chosen or names


def _explained(
    state: State, families: Sequence[Family], platform: Platform | None, sliding: bool
) -> list[Contradiction]:
    found: list[Contradiction] = []
    for _ in range(_STEPS):
        faults = faults_of(state.samples, platform, sliding)
        step = _best_step(state, families, faults)
        if step is None:
            break
        found += step.told
        state = step.state
    return found or unexplained(state)


def _doubt(
    state: State, families: Sequence[Family], faults: list[Transformation], runs: tuple[str, ...]
) -> Checked:
    """Return the likeliest cause of what is opposed and not clear, and the probability that there is one."""
    tried = _tried(state, families, faults) if state.opposed else []
    if not tried:
        return Checked()
    after, fault = _likeliest(tried)
    odds = float(np.exp(_mass(tried) - state.score))
    return Checked((), replace(told(state, after, fault, tried), runs=runs), odds / (1.0 + odds))


@dataclass(frozen=True)
class _Step:
    state: State
    told: list[Contradiction]


def _best_step(state: State, families: Sequence[Family], faults: list[Transformation]) -> _Step | None:
    """Return the best transformation if it makes a contradiction vanish, or the best two if it leaves a clear one."""
    if not state.opposed:
        return None
    tried = _tried(state, families, faults)
    single: _Step | None = None
    if tried and _mass(tried) - state.score > CLEAR:
        after, fault = _likeliest(tried)
        single = _Step(after, [told(state, after, fault, tried)])
        if not any(each.clear for each in after.opposed):
            return single
    pair = _best_pair(state, families, faults)
    if single is None or (pair is not None and pair.state.score > single.state.score):
        return pair
    return single


def _best_pair(
    state: State,
    families: Sequence[Family],
    faults: Sequence[Transformation],
) -> _Step | None:
    """Return the best two transformations of different columns, if they make a contradiction vanish."""
    best: tuple[State, Transformation, Transformation] | None = None
    if not any(each.clear for each in state.opposed):
        return None
    firsts = _tried(state, families, faults, mending=False)
    for after, fault in firsts if len(faults) <= _FEW else firsts[:_PAIRED]:
        others = [other for other in faults if not set(other.columns) & set(fault.columns)]
        for both, other in _tried(after, families, others)[:1]:
            if _mends(state, both, 2) and (best is None or both.score > best[0].score):
                best = (both, fault, other)
    if best is None or best[0].score - state.score <= CLEAR:
        return None
    after, *pair = best
    return _Step(after, [told(state, after, fault, []) for fault in pair])


def _likeliest(tried: Sequence[tuple[State, Transformation]]) -> tuple[State, Transformation]:
    """Return the best member of the likeliest cause: a duty may be of one of several supplies."""
    causes: dict[tuple[str, str], list[tuple[State, Transformation]]] = {}
    for state, fault in tried:
        causes.setdefault((fault.column, fault.suspected), []).append((state, fault))
    return max(causes.values(), key=_mass)[0]


def _mass(tried: Sequence[tuple[State, Transformation]]) -> float:
    """Return the logarithm of the sum of what all explanations are worth."""
    scores = np.array([state.score for state, _ in tried])
    return float(scores.max() + np.log(np.exp(scores - scores.max()).sum()))


def _tried(
    state: State, families: Sequence[Family], faults: Sequence[Transformation], mending: bool = True
) -> list[tuple[State, Transformation]]:
    """Return what each transformation that touches an opposed agreement leads to, the best first.

    Args:
        state: before.
        families: of redundancies.
        faults: that are tried.
        mending: whether only those count after which something is no longer opposed.
    """
    wanted = tuple({column.removesuffix("_1..4") for each in state.opposed for column in each.columns})
    tried = []
    for fault in faults:
        if any(column.startswith(wanted) or column == "t" for column in fault.columns):
            after = _after(state, families, fault)
            if not mending or _mends(state, after):
                tried.append((after, fault))
    return sorted(tried, key=lambda entry: -entry[0].score)


def _mends(before: State, after: State, least: int = 1) -> bool:
    """Whether so many agree clearly better, and nothing is opposed that was not; two faults need two witnesses.

    Two exact series have to agree. A law may be left in doubt, and come into doubt where exact series agree again:
    beside a wrong unit, physics may be at work that it does not know.
    """
    then, now = ({each.name: each for each in state.opposed} for state in (before, after))
    better = [
        name
        for name, each in then.items()
        if name not in now or (not each.is_exact and now[name].support > each.support + CLEAR)
    ]
    exact = any(then[name].is_exact for name in better)
    spoilt = [each for name, each in now.items() if name not in then and (each.is_exact or not exact)]
    return not spoilt and len(better) >= least


def _state(samples: Samples, families: Sequence[Family]) -> State:
    found = tuple(family.agreements(samples) for family in families)
    return State(samples, found, support_of(found))


def _after(state: State, families: Sequence[Family], fault: Transformation) -> State:
    """Return the state in which a transformation is undone; what it does not touch is not compared again."""
    samples = fault.undo(state.samples)
    found = tuple(
        _beside(family.agreements(samples), before) if family.sees(fault.columns) else before
        for family, before in zip(families, state.found, strict=True)
    )
    score = state.score - support_of(state.found) + support_of(found) + float(np.log(fault.odds))
    return State(samples, found, score)


def _beside(after: Agreements, before: Agreements) -> Agreements:
    """Return the agreements after a change; one that appears or vanishes with it speaks for neither side."""
    kept = {
        name: each if name in before else replace(each, support=min(each.support, 0.0))
        for name, each in after.items()
    }
    gone = {
        name: replace(each, support=min(each.support, 0.0), opposed=False, clear=False)
        for name, each in before.items()
        if name not in after
    }
    return kept | gone
