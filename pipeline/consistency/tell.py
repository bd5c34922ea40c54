"""What is said of a contradiction: the evidence, the cause, and how sure it is."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from simgap.consistency.families import Agreements
from simgap.consistency.redundancy import Agreement
from simgap.consistency.samples import Samples
from simgap.consistency.transformation import Transformation
from simgap.recordings.contradiction import SUSPECTED, Contradiction

_ALIKE = 0.8  # correlation from which on the sizes of two exact series are compared
_LARGEST = 3.0  # ratio of two exact series that filters and lags cannot make


@dataclass(frozen=True)
class State:
    """A recording with some transformations undone.

    Attributes:
        samples: of the recording.
        found: the agreements of each family.
        score: of this explanation.
    """

    samples: Samples
    found: tuple[Agreements, ...]
    score: float

    @property
    def opposed(self) -> list[Agreement]:
        """What still contradicts, the clearest first."""
        every = (each for found in self.found for each in found.values() if each.opposed)
        return sorted(every, key=lambda each: each.support)


def support_of(found: Sequence[Agreements]) -> float:
    """Return the log likelihood of all agreements together."""
    return sum(each.support for agreements in found for each in agreements.values())


def told(
    before: State, after: State, fault: Transformation, tried: Sequence[tuple[State, Transformation]]
) -> Contradiction:
    """Return what is said of a transformation.

    Args:
        before: the recording as it stands.
        after: with it undone.
        fault: the transformation.
        tried: it and its rivals.
    """
    gains = {
        name: agreement.support - then[name].support if name in then else agreement.support
        for found, then in zip(before.found, after.found, strict=True)
        for name, agreement in found.items()
    }
    worst = min(gains, key=lambda name: gains[name])
    agreement = next(found[worst] for found in before.found if worst in found)
    words = f" ({fault.words})" if fault.words else ""
    sure = f"with {fault.column!r} as {SUSPECTED[fault.suspected]}{words} undone, the recording agrees"
    rival = _rival(after, fault, tried)
    return Contradiction(fault.column, fault.suspected, f"{agreement.evidence}; {sure}{rival}", fault.remedy)


def _rival(after: State, fault: Transformation, tried: Sequence[tuple[State, Transformation]]) -> str:
    """Return how sure the cause is against the next one that is another."""
    others = [
        (state, other)
        for state, other in tried
        if (other.column, other.suspected) != (fault.column, fault.suspected)
    ]
    if not others:
        return ""
    state, other = others[0]
    odds = float(np.exp(min(after.score - state.score, np.log(1000.0))))
    if odds >= 1000.0:
        return " (odds above 1000 to 1)"
    return f" (odds {odds:.2g} to 1 against {SUSPECTED[other.suspected]} of {other.column!r})"


def unexplained(state: State) -> list[Contradiction]:
    """Return what two exact series contradict beyond doubt although no transformation explains it."""
    found = []
    for each in state.opposed:
        rate, *others = each.columns
        if not each.is_exact:
            continue
        other = others[0] if others else rate
        if each.alike < -_ALIKE:
            found.append(Contradiction(rate, "sign", each.evidence, f"Negate {rate!r}, or {other!r}."))
        elif each.alike > _ALIKE and not 1.0 / _LARGEST < each.ratio < _LARGEST:
            remedy = f"Convert {rate!r} or {other!r}: their units do not agree."
            found.append(Contradiction(rate, "unit", each.evidence, remedy))
    return found
