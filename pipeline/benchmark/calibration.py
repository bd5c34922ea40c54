"""Recalibration fitted: a logistic regression of "the effect is there" on what the posterior says.

That is the log odds of the effect, and whether the best hypothesis misses a part of the recording.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from simgap.benchmark.reliability import brier_score, calibration_error
from simgap.errors import InputError
from simgap.gap.calibration import Calibration, log_odds
from simgap.gap.settings import POSSIBLE

SEEDS = range(10_000, 20_000)
"""Seeds of benchmarks that probabilities are fitted to; those of every other benchmark are for scoring."""

_LEAST_STATEMENTS = 40
"""Fewest statements of a fit: with fewer, the prior would decide as much as they do."""
_WIDTH = 1.0
"""Standard deviation of the priors about 0: of the intercept, of the slope's logarithm, and of what is taken off.

One unit of log odds, and a factor of e: the posterior is expected to be about right, as far as nothing else is shown.
"""
_FOLDS = 5
"""Parts of the cross-validation: each fit has four fifths of the cases."""


@dataclass(frozen=True)
class Statement:
    """One effect that a posterior thought possible.

    Attributes:
        case: name of the case.
        probability: that the posterior gave it, before recalibration.
        share: of the error that it explained in the channel where it explained most.
        true: whether the effect was concealed in the case.
    """

    case: str
    probability: float
    share: float
    true: bool


def is_for_calibration(seed: int) -> bool:
    """Whether a seed is reserved for calibration; other seeds are for scoring."""
    return seed in SEEDS


def statements_of(results: Sequence[Mapping[str, Any]], code: str) -> list[Statement]:
    """Return every effect that a posterior gave `POSSIBLE` or more, and whether it was concealed.

    Args:
        results: of `simgap prove`. `posterior` holds the probability by key of the effect, before recalibration, and
            `shares` the shares of the error that possible effects explained.
        code: hash of the present score (`simgap.gap.calibration.hash_of_score`).

    Raises:
        InputError: when a result belongs to a seed that is for scoring, or to another version of the score.
    """
    return [statement for result in results for statement in _statements(result, code)]


def _statements(result: Mapping[str, Any], code: str) -> Iterator[Statement]:
    _check(result, code)
    concealed = set(result.get("score", {}).get("concealed", ()))
    grouped = any("@" in name for name in concealed)
    for key, probability in (result.get("posterior") or {}).items():
        if probability >= POSSIBLE:
            name = key if grouped else key.partition("@")[0]
            yield Statement(result["name"], probability, result["shares"][key], name in concealed)


def _check(result: Mapping[str, Any], code: str) -> None:
    """Refuse a result that nothing may be fitted to."""
    if not is_for_calibration(result["seed"]):
        where = f"{SEEDS.start} to {SEEDS.stop - 1}"
        raise InputError(f"seed {result['seed']} is for scoring", result["name"], f"use seeds from {where}")
    if result.get("posterior") and result.get("code") != code:
        raise InputError(
            "was diagnosed by another version of the score", result["name"], "run simgap prove again"
        )


def fit_calibration(statements: Sequence[Statement]) -> dict[str, Any]:
    """Fit the recalibration, and measure it on left-out cases.

    Returns:
        `intercept`, `slope`, `unexplained`, `statements`, `true`, and, cross-validated over cases, `brier_score` and
        `expected_calibration_error`.

    Raises:
        InputError: when there are too few statements, or all are alike.
    """
    right = sum(statement.true for statement in statements)
    if len(statements) < _LEAST_STATEMENTS or right in (0, len(statements)):
        what = f"{len(statements)} statements, {right} of them true, are too few"
        raise InputError(what, "prove.results", "run more cases with calibration seeds")
    stated = list(zip(_cross_validated(statements), (s.true for s in statements), strict=True))
    return asdict(_fitted(statements)) | {
        "statements": len(statements),
        "true": right,
        "brier_score": brier_score(stated),
        "expected_calibration_error": calibration_error(stated),
    }


def _fitted(statements: Sequence[Statement]) -> Calibration:
    """Return the most probable recalibration. The slope's logarithm is fitted, so that it stays above zero."""
    from scipy.optimize import minimize

    odds = np.array([log_odds(statement.probability) for statement in statements])
    left = np.array([1.0 - statement.share for statement in statements])
    sign = np.array([1.0 if statement.true else -1.0 for statement in statements])

    def cost(place: NDArray[np.float64]) -> float:
        corrected = place[0] + math.exp(place[1]) * odds - place[2] * left
        wrongness = np.logaddexp(0.0, -sign * corrected).sum()
        return float(wrongness + 0.5 * (place @ place) / _WIDTH**2)

    intercept, stretch, unexplained = minimize(cost, np.zeros(3), method="BFGS").x.tolist()
    return Calibration(intercept, math.exp(stretch), unexplained)


def _cross_validated(statements: Sequence[Statement]) -> list[float]:
    """Return each statement's recalibrated probability, by a fit to the cases of the other folds."""
    from sklearn.model_selection import GroupKFold  # of an extra that only this needs

    cases = [statement.case for statement in statements]
    folds = GroupKFold(min(_FOLDS, len(set(cases))))
    found = [0.0] * len(statements)
    for others, left_out in folds.split(cases, groups=cases):
        fitted = _fitted([statements[place] for place in others])
        for place in left_out:
            found[place] = fitted(statements[place].probability, statements[place].share)
    return found
