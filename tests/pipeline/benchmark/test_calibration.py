"""Probabilities fitted to how often names were right."""

import math
from dataclasses import replace

import numpy as np
import pytest

from simgap.benchmark.calibration import (
    SEEDS,
    Statement,
    fit_calibration,
    is_for_calibration,
    statements_of,
)
from simgap.errors import InputError
from simgap.gap.probability import DIRECTIONS

SEED = SEEDS.start
KINDS = ("joint", "quadrotor")


def statements(count, rule, seed=0):
    """Draw statements whose truth has the probability that `rule` makes of standard normal features."""
    random = np.random.default_rng(seed)
    drawn = []
    for number in range(count):
        features = dict(zip(DIRECTIONS, random.standard_normal(len(DIRECTIONS)).tolist(), strict=True))
        probability = 1.0 / (1.0 + math.exp(-rule(features)))
        kind = KINDS[number % len(KINDS)]
        drawn.append(
            Statement(f"case-{number // 2}", features, kind, 1.0, bool(random.random() < probability))
        )
    return drawn


def test_known_probabilities_are_recovered():
    found = fit_calibration(statements(6000, lambda f: 0.5 + 2.0 * f["evidence"] - 1.0 * f["excess"]))
    assert found["intercept"] == pytest.approx(0.5, abs=0.15)
    assert found["coefficients"]["evidence"] == pytest.approx(2.0, abs=0.2)
    assert found["coefficients"]["excess"] == pytest.approx(-1.0, abs=0.15)
    assert abs(found["coefficients"]["number"]) < 0.1
    assert found["expected_calibration_error"] < 0.03
    assert found["statements"] == 6000


def test_every_kind_has_its_own_intercept():
    joints = [replace(s, kind="joint") for s in statements(2000, lambda f: 1.0 + f["evidence"])]
    others = [replace(s, kind="quadrotor") for s in statements(2000, lambda f: f["evidence"] - 1.0, seed=1)]
    found = fit_calibration([*joints, *others])
    assert found["offsets"]["joint"] - found["offsets"]["quadrotor"] == pytest.approx(2.0, abs=0.3)
    assert found["coefficients"]["evidence"] == pytest.approx(1.0, abs=0.15)
    assert found["expected_calibration_error"] < 0.03


def test_more_evidence_never_lowers_a_probability():
    found = fit_calibration(statements(2000, lambda f: -2.0 * f["evidence"] - 1.0 * f["excess"]))
    assert found["coefficients"]["evidence"] == 0.0
    for name, direction in DIRECTIONS.items():
        assert found["coefficients"][name] * direction >= 0.0


def test_a_feature_that_never_changes_does_no_harm():
    drawn = [
        Statement(s.case, s.features | {"signal": 1.0}, s.kind, 1.0, s.true)
        for s in statements(500, lambda f: f["evidence"])
    ]
    assert math.isfinite(fit_calibration(drawn)["intercept"])


def test_rivals_share_what_presence_says():
    random = np.random.default_rng(1)
    drawn = statements(3000, lambda f: 2.0 * f["evidence"])
    shared = [
        Statement(s.case, s.features, s.kind, 0.5, s.true and bool(random.random() < 0.5))
        for s in statements(3000, lambda f: 2.0 * f["evidence"], seed=1)
    ]
    found = fit_calibration([*drawn, *shared])
    assert found["coefficients"] == fit_calibration(drawn)["coefficients"]
    assert found["expected_calibration_error"] < 0.03


@pytest.mark.parametrize("count", [10, 200])
def test_too_few_or_one_sided_statements_are_refused(count):
    with pytest.raises(InputError, match="are too few"):
        fit_calibration(statements(count, lambda f: 50.0 if count == 200 else f["evidence"]))


def result(seed=SEED, concealed=("rotor_drag",), **features):
    bare = {"gain": 50.0, "parameters": 1, "clusters": 20}
    return {
        "name": "quadrotor-0",
        "seed": seed,
        "score": {"concealed": list(concealed)},
        "features": dict.fromkeys(features, bare),
    }


def test_statements_are_told_true_by_the_key():
    found = statements_of([result(rotor_drag=1, body_drag=1)])
    assert [(s.true, s.case) for s in found] == [(True, "quadrotor-0"), (False, "quadrotor-0")]
    assert found[0].features["evidence"] == pytest.approx(math.asinh(50.0 - 0.5 * math.log(20)))


def test_groups_count_only_where_the_key_has_them():
    (grouped,) = statements_of([result(concealed=["friction@steer"], **{"friction@drive": 1})])
    (bare,) = statements_of([result(concealed=["rotor_fault"], **{"rotor_fault@3": 1})])
    assert (grouped.true, bare.true) == (False, True)


def test_what_scores_is_never_fitted_to():
    assert not is_for_calibration(1)
    with pytest.raises(InputError, match="seed 1 is for scoring"):
        statements_of([result(seed=1, rotor_drag=1)])


def test_a_failed_case_states_nothing():
    assert statements_of([{"name": "x", "seed": SEED}]) == []
