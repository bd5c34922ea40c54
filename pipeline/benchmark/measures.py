"""The figures of merit of the benchmark, over all cases and per kind and effect."""

import math
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from simgap.benchmark.intervals import Share, quantile, share_of
from simgap.benchmark.reliability import brier_score, calibration_error, calibration_error_by_chance
from simgap.benchmark.score import BELIEVED

Result = Mapping[str, Any]


@dataclass(frozen=True)
class Bar:
    """A target of the benchmark.

    Attributes:
        name: what is measured.
        wanted: target value.
        at_least: whether larger is better.
        measured: computes the value from results; a share or a number.
        percent: whether it is printed as a percentage.
    """

    name: str
    wanted: float
    at_least: bool
    measured: Callable[[Sequence[Result]], Share | float]
    percent: bool = True


def category(result: Result) -> str:
    """Return the category of a case."""
    return str(result["case"]["subject"]["category"])


def strength(result: Result) -> str:
    """Return `clear`, `faint`, or nothing."""
    return str(result["case"]["subject"]["strength"])


def is_case(result: Result) -> bool:
    """Whether the effect reaches the size that its category demands (`stages/_strengths.py`), or the case failed."""
    return "score" in result or "failed" in result


def scored(results: Iterable[Result]) -> list[Result]:
    """Return the results that have a score: all but those that failed."""
    return [result for result in results if "score" in result]


def of(results: Iterable[Result], *categories: str) -> list[Result]:
    """Return the results of some categories."""
    return [result for result in results if category(result) in categories]


def named_first(results: Iterable[Result]) -> Share:
    """Return the share of cases whose first name is right; failed cases count as wrong."""
    return share_of(result.get("score", {}).get("outcome") == "right" for result in results)


def recall(results: Iterable[Result]) -> Share:
    """Return the share of concealed effects that are named with a probability of a half or more."""
    scores = [result["score"] for result in scored(results)]
    found = sum(score["found"] * len(score["concealed"]) for score in scores)
    return Share(found, sum(len(score["concealed"]) for score in scores))


def false_alarms(results: Iterable[Result]) -> Share:
    """Return the share of null cases in which anything is named."""
    return share_of(result["score"]["outcome"] == "wrong" for result in scored(of(results, "nothing")))


def false_names(results: Sequence[Result]) -> float:
    """Return how many wrong names stand at the level of belief or above it, per case."""
    cases = scored(results)
    wrong = sum(p >= BELIEVED and not true for case in cases for p, true in case["score"]["stated"])
    return wrong / len(cases) if cases else math.nan


def ambiguous_or_right(results: Iterable[Result]) -> Share:
    """Return the share of ambiguous recordings whose right name comes first, or is listed as ambiguous."""
    outcomes = (r["score"]["outcome"] for r in scored(of(results, "ambiguous")))
    return share_of(outcome in ("right", "ambiguous") for outcome in outcomes)


def all_found(results: Iterable[Result]) -> Share:
    """Return the share of published recordings of which every known effect is believed."""
    scores = (result["score"] for result in results)
    return share_of(not score["missed"] and not score["undecided"] for score in scores)


def explained_enough(results: Iterable[Result]) -> Share:
    """Return the share of published recordings of whose held-out error names explain four fifths of what can be."""
    return share_of(result["score"]["explained_enough"] for result in results)


def parameter_error(results: Iterable[Result]) -> float:
    """Return the median relative error of the first parameter of every concealed effect that was named."""
    return quantile(first_errors(results), 0.5)


def first_errors(results: Iterable[Result]) -> list[float]:
    """Return the relative error of each found effect's strength, its first parameter."""
    every = [errors for result in scored(results) for errors in result["score"]["errors"].values()]
    return [next(iter(errors.values())) for errors in every if errors]


def gaps_closed(results: Iterable[Result]) -> list[float]:
    """Return the share of the gap closed wherever an effect is concealed."""
    present = [r["score"] for r in scored(results) if r["score"]["concealed"]]
    return [score["gap_closed"] for score in present if score["gap_closed"] is not None]


def greatest_wrong(results: Iterable[Result]) -> float:
    """Return the greatest probability of a wrong name in cases outside the catalogue; 0 where nothing is wrong."""
    stated = [pair for r in scored(of(results, "outside")) for pair in r["score"]["stated"]]
    return max((probability for probability, true in stated if not true), default=0.0)


def stated(results: Iterable[Result]) -> list[tuple[float, bool]]:
    """Return every stated probability with what was true."""
    return [(float(p), bool(true)) for result in scored(results) for p, true in result["score"]["stated"]]


def seconds(results: Iterable[Result]) -> float:
    """Return the median time of a diagnosis from recording to answer, s."""
    return quantile([result["seconds"] for result in results if "seconds" in result], 0.5)


def longest(results: Iterable[Result]) -> float:
    """Return the time within which nine of ten diagnoses are done, s."""
    return quantile([result["seconds"] for result in results if "seconds" in result], 0.9)


BARS = (
    Bar("clear effects named first", 0.97, True, lambda r: named_first(of(r, "clear"))),
    Bar("faint effects named first", 0.85, True, lambda r: named_first(of(r, "faint"))),
    Bar("effects of pairs found", 0.90, True, lambda r: recall(of(r, "pair"))),
    Bar("nulls in which something is named", 0.02, False, false_alarms),
    Bar("false names at 0.5 or more, per case", 0.03, False, false_names, percent=False),
    Bar("with physics outside the catalogue: effects found", 0.70, True, lambda r: recall(of(r, "mixed"))),
    Bar("driver not recorded: effect named first", 0.75, True, lambda r: named_first(of(r, "hidden"))),
    Bar("ambiguous excitation: named first, or listed as ambiguous", 0.90, True, ambiguous_or_right),
    Bar("parameter error, median", 0.10, False, parameter_error),
    Bar("gap closed, median", 0.90, True, lambda r: quantile(gaps_closed(r), 0.5)),
    Bar(
        "greatest probability of a wrong name outside the catalogue",
        0.5,
        False,
        greatest_wrong,
        percent=False,
    ),
    Bar("expected calibration error", 0.03, False, lambda r: calibration_error(stated(r)), percent=False),
    Bar("Brier score", 0.06, False, lambda r: brier_score(stated(r)), percent=False),
    Bar("seconds per case, nine of ten within", 60.0, False, longest, percent=False),
)
"""The targets of the diagnosis on concealed cases."""

PUBLISHED_BARS = (
    Bar("published recordings of which every known effect is found", 15 / 18, True, all_found),
    Bar("of which names explain four fifths of what a regression explains", 14 / 18, True, explained_enough),
)
"""Those on published recordings."""


def is_met(bar: Bar, value: Share | float) -> bool | None:
    """Return whether a bar is met; None where nothing was measured."""
    number = value.value if isinstance(value, Share) else value
    if math.isnan(number):
        return None
    return number >= bar.wanted if bar.at_least else number <= bar.wanted


def confusions(results: Iterable[Result]) -> list[tuple[str, str, int]]:
    """Return (concealed, named first instead, count), the most frequent first."""
    pairs: Counter[tuple[str, str]] = Counter()
    for result in results:
        outcome = result.get("score", {}).get("outcome", "failed")
        if outcome != "right":
            subject = result["case"]["subject"]
            hidden = "+".join(subject["names"]) or "nothing"
            pairs[f"{hidden} ({subject['category']})", _instead(result, outcome)] += 1
    return [(hidden, instead, count) for (hidden, instead), count in pairs.most_common()]


def _instead(result: Result, outcome: str) -> str:
    named = result.get("score", {}).get("named", [])
    return named[0][0] if named and outcome in ("wrong", "ambiguous") else outcome


def overall(results: Sequence[Result]) -> dict[str, Share | float | int]:
    """Return the figures without a target."""
    begun = [right for result in scored(results) for right in result["score"].get("runs_right", ())]
    later: dict[str, Share | float | int] = {}
    if begun:
        later["effects that begin later: named with the right runs"] = share_of(begun)
    return later | {
        "decoys with the right verdict": share_of(
            r["score"]["verdict_right"] for r in scored(of(results, "decoy"))
        ),
        "decoys named first": named_first(of(results, "decoy")),
        "nulls with verdict none": share_of(
            r["score"]["verdict_right"] for r in scored(of(results, "nothing"))
        ),
        "outside the catalogue: nothing named above 0.5": share_of(
            not any(p > 0.5 and not true for p, true in r["score"]["stated"])
            for r in scored(of(results, "outside"))
        ),
        "abstentions: a gap is found, but no name": share_of(
            r["score"]["outcome"] == "unnamed" for r in scored(results) if r["score"]["concealed"]
        ),
        "expected calibration error of perfectly calibrated probabilities (chance)": calibration_error_by_chance(
            stated(results)
        ),
        "stated probabilities": len(stated(results)),
        "cases that failed": share_of("failed" in result for result in results),
    }
