"""Probabilities fitted to how often names were right."""

import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from simgap.benchmark.calibration import (
    SEEDS,
    Statement,
    fit_calibration,
    is_for_calibration,
    statements_of,
)
from simgap.errors import InputError
from simgap.gap import calibration
from simgap.gap.calibration import CALIBRATION, Calibration, hash_of_score
from simgap.gap.settings import POSSIBLE
from simgap.runner import StageRun
from simgap.stages._benchmark_case import _diagnosed
from simgap.stages.calibrate import CalibrateStage, calibrate

SEED = SEEDS.start
CODE = "the present score"


def drawn(
    count: int, intercept: float, slope: float, unexplained: float = 0.0, seed: int = 0
) -> list[Statement]:
    """Draw statements, two a case, that are as often true as a calibration makes of their log odds."""
    random = np.random.default_rng(seed)
    truth = Calibration(intercept, slope, unexplained)
    probabilities = 1.0 / (1.0 + np.exp(-random.uniform(-2.9, 6.0, count)))
    told = list(zip(probabilities.tolist(), random.random(count).tolist(), strict=True))
    return [
        Statement(f"case-{number // 2:05d}", *each, bool(random.random() < truth(*each)))
        for number, each in enumerate(told)
    ]


@pytest.mark.parametrize(
    ("intercept", "slope", "unexplained"),
    [(0.0, 1.0, 0.0), (-1.0, 0.5, 1.5), (0.5, 1.5, 1.0), (-0.3, 0.2, -0.5)],
)
def test_known_numbers_are_recovered(intercept: float, slope: float, unexplained: float) -> None:
    found = fit_calibration(drawn(8000, intercept, slope, unexplained))
    assert found["intercept"] == pytest.approx(intercept, abs=0.2)
    assert found["slope"] == pytest.approx(slope, abs=0.05, rel=0.1)
    assert found["unexplained"] == pytest.approx(unexplained, abs=0.3)
    assert found["expected_calibration_error"] < 0.02
    assert found["statements"] == 8000


def test_boasting_is_corrected_on_cases_that_were_left_out() -> None:
    boasts = drawn(2000, -1.0, 0.4)
    found = fit_calibration(boasts)
    raw = sum((s.probability - s.true) ** 2 for s in boasts) / len(boasts)
    assert found["brier_score"] < 0.8 * raw
    assert found["expected_calibration_error"] < 0.05


def test_few_statements_move_the_probabilities_less() -> None:
    """Of the same shares that are true, forty statements are believed less than eight hundred."""
    few, many = (fit_calibration(drawn(40, -3.0, 1.0) * times) for times in (1, 20))
    assert abs(few["intercept"]) < abs(many["intercept"])


def test_sure_and_right_stays_finite() -> None:
    certain = [Statement(f"a-{n}", 1.0, 1.0, True) for n in range(60)]
    certain += [Statement(f"b-{n}", 0.05, 1.0, False) for n in range(60)]
    found = fit_calibration(certain)
    assert 1.0 <= found["slope"] < math.e**2
    assert found["brier_score"] < 0.01


@settings(max_examples=30)
@given(st.integers(0, 1000), st.floats(-3.0, 3.0), st.floats(-2.0, 2.0))
def test_the_order_is_kept_whatever_the_statements_say(seed: int, intercept: float, tilt: float) -> None:
    """Also where the likelier ones are wrong more often."""
    random = np.random.default_rng(seed)
    statements = [
        Statement(
            str(n),
            p,
            1.0,
            bool(random.random() < 1.0 / (1.0 + math.exp(-intercept - tilt * 4.0 * (p - 0.5)))),
        )
        for n, p in enumerate(random.uniform(0.05, 1.0, 60).tolist())
    ]
    statements += [Statement("right", 0.5, 1.0, True), Statement("wrong", 0.5, 1.0, False)]
    found = fit_calibration(statements)
    fitted = Calibration(found["intercept"], found["slope"])
    assert fitted(0.1) < fitted(0.5) < fitted(0.9)


@pytest.mark.parametrize(
    "statements", [drawn(10, 0.0, 1.0), [Statement(str(n), 0.9, 1.0, True) for n in range(200)]]
)
def test_too_few_or_one_sided_statements_are_refused(statements: Sequence[Statement]) -> None:
    with pytest.raises(InputError, match="are too few"):
        fit_calibration(statements)


def result(
    seed: int = SEED, concealed: Sequence[str] = ("rotor_drag",), share: float = 1.0, **posterior: float
) -> dict[str, Any]:
    key = {"score": {"concealed": list(concealed)}, "posterior": posterior, "code": CODE}
    key["shares"] = dict.fromkeys(posterior, share)
    return {"name": f"quadrotor-{seed}-0000", "seed": seed, "case": {"kind": "quadrotor"}, **key}


def test_statements_are_told_true_by_the_key() -> None:
    found = statements_of([result(rotor_drag=0.9, body_drag=0.2, payload=0.01)], CODE)
    name = f"quadrotor-{SEED}-0000"
    assert found == [Statement(name, 0.9, 1.0, True), Statement(name, 0.2, 1.0, False)]


def test_what_nobody_would_name_is_no_statement() -> None:
    found = statements_of([result(a=POSSIBLE, b=POSSIBLE - 1e-9)], CODE)
    assert [statement.probability for statement in found] == [POSSIBLE]


def test_groups_count_only_where_the_key_has_them() -> None:
    (grouped,) = statements_of([result(concealed=["friction@steer"], **{"friction@drive": 1.0})], CODE)
    (bare,) = statements_of([result(concealed=["friction"], **{"friction@drive": 1.0})], CODE)
    assert (grouped.true, bare.true) == (False, True)


@pytest.mark.parametrize("seed", [1, SEEDS.start - 1, SEEDS.stop])
def test_what_scores_is_never_fitted_to(seed: int) -> None:
    assert not is_for_calibration(seed)
    with pytest.raises(InputError, match=f"seed {seed} is for scoring"):
        statements_of([result(seed=seed, rotor_drag=1.0)], CODE)


def test_results_of_another_version_are_refused() -> None:
    with pytest.raises(InputError, match="another version of the score; run simgap prove again"):
        statements_of([result(rotor_drag=1.0)], "a newer score")


def test_a_failed_case_states_nothing() -> None:
    assert statements_of([{"name": "x", "seed": SEED}], CODE) == []


def test_a_case_keeps_its_posterior_as_it_was_before_recalibration(tmp_path: Path) -> None:
    assert _diagnosed({}, tmp_path, ()) == {}
    evidence = tmp_path / "diagnose" / "evidence"
    evidence.mkdir(parents=True)
    (evidence.parent / "diagnosis.json").write_text('{"verdict": "none"}')
    assert _diagnosed({}, tmp_path, ()) == {"diagnosis": {"verdict": "none"}}
    (evidence / "posterior.json").write_text(
        '{"probabilities": {"rotor_drag": 0.9}, "shares": {"rotor_drag": 0.4}}'
    )
    found = _diagnosed({}, tmp_path, ())
    assert (found["posterior"], found["shares"]) == ({"rotor_drag": 0.9}, {"rotor_drag": 0.4})


def written(folder: Path, statements: Sequence[Statement], **changes: Any) -> str:
    """Write results in which each statement is a case, and a published recording beside them."""
    code = hash_of_score()
    cases = [
        result(
            SEED + number % 2,
            ("rotor_drag",) if statement.true else (),
            statement.share,
            rotor_drag=statement.probability,
        )
        | {"name": str(number), "code": code}
        | changes
        for number, statement in enumerate(statements)
    ]
    file = folder / "results.json"
    file.write_text(json.dumps([*cases, {"name": "real-servo", "branch": "servo"}]))
    return str(file)


def test_the_stage_writes_what_the_diagnosis_reads(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    stored = tmp_path / "stored" / "calibration.yaml"
    stored.parent.mkdir()
    monkeypatch.setattr(calibration, "CALIBRATION", stored)
    config = CalibrateStage()
    config.prove.results = [written(tmp_path, drawn(400, -0.5, 0.8))]
    calibrate(config, StageRun(tmp_path))
    assert not stored.exists()
    config.prove.write_calibration = True
    calibrate(config, StageRun(tmp_path))
    assert stored.read_text() == (tmp_path / "calibration.yaml").read_text()
    content = yaml.safe_load(stored.read_text())
    assert content["made_by"] == "simgap calibrate on 400 cases"
    assert (content["seeds"], content["kinds"]) == ([SEED, SEED + 1], ["quadrotor"])
    assert (content["code"], content["statements"]) == (hash_of_score(), 400)
    assert content["slope"] == pytest.approx(0.8, rel=0.3)
    assert list(content) == list(yaml.safe_load(CALIBRATION.read_text()))


def test_the_stage_refuses_what_scores(tmp_path: Path) -> None:
    config = CalibrateStage()
    config.prove.results = [written(tmp_path, drawn(50, 0.0, 1.0), seed=7)]
    with pytest.raises(InputError, match="seed 7 is for scoring"):
        calibrate(config, StageRun(tmp_path))
