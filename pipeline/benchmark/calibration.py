"""Calibration of probabilities: a logistic regression of "the named effect is present" on its features."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from simgap.benchmark.reliability import brier_score, calibration_error
from simgap.errors import InputError
from simgap.gap.probability import DIRECTIONS, Calibration, Features

SEEDS = range(10_000, 20_000)
"""Seeds of benchmarks that probabilities are fitted to; those of every other benchmark are for scoring."""

_LEAST_STATEMENTS = 40
_PENALTY = 1.0  # one observation's worth of doubt about every standardised coefficient
_FOLDS = 5


@dataclass(frozen=True)
class Statement:
    """One effect that a diagnosis named.

    Attributes:
        case: name of the case.
        features: `Features.scaled`, by name.
        kind: kind of platform.
        weight: posterior weight of the effect among its look-alikes.
        true: whether the effect is present.
    """

    case: str
    features: dict[str, float]
    kind: str
    weight: float
    true: bool


def is_for_calibration(seed: int) -> bool:
    """Whether a seed is reserved for calibration; other seeds are for scoring."""
    return seed in SEEDS


def statements_of(results: Sequence[Mapping[str, Any]]) -> list[Statement]:
    """Return every named effect with its features and whether it was concealed.

    Raises:
        InputError: when a result belongs to a seed that is for scoring.
    """
    statements = []
    for result in results:
        if not is_for_calibration(result["seed"]):
            where = f"{SEEDS.start} to {SEEDS.stop - 1}"
            raise InputError(
                f"seed {result['seed']} is for scoring", result["name"], f"use seeds from {where}"
            )
        concealed = set(result.get("score", {}).get("concealed", ()))
        grouped = any("@" in name for name in concealed)
        for key, features in (result.get("features") or {}).items():
            name = key if grouped else key.partition("@")[0]
            known = Features(**features)
            statements.append(
                Statement(result["name"], known.scaled, known.kind, known.weight, name in concealed)
            )
    return statements


def fit_calibration(statements: Sequence[Statement]) -> dict[str, Any]:
    """Fit the logistic regression and measure its calibration on left-out cases.

    A feature whose coefficient comes out against its direction is left out: more evidence never lowers a probability.
    Every kind of platform has an intercept of its own, drawn towards that of all (partial pooling).
    Effects with rivals are left out of the fit, since their probability is that of presence times their weight; the
    figures beside it count them.

    Returns:
        `intercept`, `coefficients` by feature, `offsets` by kind, `statements`, `true`, and, cross-validated over
        cases, `brier_score` and `expected_calibration_error`.

    Raises:
        InputError: when there are too few statements, or all are alike.
    """
    alone = [statement.true for statement in statements if statement.weight == 1.0]
    right = sum(alone)
    if len(alone) < _LEAST_STATEMENTS or right in (0, len(alone)):
        what = f"{len(alone)} statements, {right} of them true, are too few"
        raise InputError(what, "prove.results", "run more cases with calibration seeds")
    fitted = _fitted(statements)
    kept = [(p, s.true) for p, s in zip(_cross_validated(statements), statements, strict=True)]
    return asdict(fitted) | {
        "statements": len(statements),
        "true": sum(statement.true for statement in statements),
        "brier_score": brier_score(kept),
        "expected_calibration_error": calibration_error(kept),
    }


def _fitted(statements: Sequence[Statement]) -> Calibration:
    from sklearn.linear_model import LogisticRegression

    alone = [statement for statement in statements if statement.weight == 1.0]
    true = np.array([statement.true for statement in alone])
    kinds = sorted({statement.kind for statement in alone})
    own = np.array([[float(statement.kind == kind) for kind in kinds] for statement in alone])
    names = [] if true.all() or not true.any() else list(DIRECTIONS)  # a fold may hold all that is wrong
    while names:
        matrix = np.array([[statement.features[name] for name in names] for statement in alone])
        centre, spread = matrix.mean(0), np.maximum(matrix.std(0), 1e-9)
        table = np.hstack([(matrix - centre) / spread, own])
        model = LogisticRegression(C=1.0 / _PENALTY, solver="newton-cholesky", tol=1e-8).fit(table, true)
        slopes: NDArray[np.float64] = model.coef_[0, : len(names)] / spread
        wrong = [name for name, slope in zip(names, slopes, strict=True) if slope * DIRECTIONS[name] < 0]
        if not wrong:
            found = dict(zip(names, slopes.tolist(), strict=True))
            intercept = float(model.intercept_[0] - slopes @ centre)
            offsets = dict(zip(kinds, model.coef_[0, len(names) :].tolist(), strict=True))
            return Calibration(intercept, {name: found.get(name, 0.0) for name in DIRECTIONS}, offsets)
        names = [name for name in names if name not in wrong]
    rate = float((true.sum() + 1.0) / (len(true) + 2.0))
    return Calibration(math.log(rate / (1.0 - rate)), dict.fromkeys(DIRECTIONS, 0.0), {})


def _cross_validated(statements: Sequence[Statement]) -> list[float]:
    """Return each statement's probability from a fit without its case and others."""
    cases = sorted({statement.case for statement in statements})
    fold = {case: number % _FOLDS for number, case in enumerate(cases)}
    stated = [0.0] * len(statements)
    for part in range(_FOLDS):
        fitted = _fitted([statement for statement in statements if fold[statement.case] != part])
        for place, statement in enumerate(statements):
            if fold[statement.case] == part:
                presence = fitted.presence(statement.features, statement.kind)
                stated[place] = statement.weight * presence
    return stated
