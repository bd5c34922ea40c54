"""The recalibration of probabilities, and the code that it was fitted with."""

import shutil
from pathlib import Path

import pytest
import yaml
from hypothesis import example, given
from hypothesis import strategies as st

from simgap.gap import calibration
from simgap.gap.calibration import CALIBRATION, MODULES, Calibration, calibrated, hash_of_score, log_odds

PACKAGE = CALIBRATION.parents[1]
CONTENT = yaml.safe_load(CALIBRATION.read_text(encoding="utf-8"))
PROBABILITIES = st.floats(0.0, 1.0)
CALIBRATIONS = st.builds(Calibration, st.floats(-3.0, 3.0), st.floats(0.1, 3.0), st.floats(0.0, 3.0))

STALE = f"""{CALIBRATION.name} was made with another version of the engine's score, so its probabilities may be off.
Diagnose the cases of calibration seeds again, and fit the recalibration to them:
    make prove SEED=10050 CASES=60
    simgap calibrate 'prove.results=[FILE, ...]' prove.write_calibration=true
Each FILE is a results.json of make prove. Comments and docstrings do not count as a change."""


def test_the_calibration_was_made_with_the_present_score() -> None:
    if CONTENT["code"] != hash_of_score():
        pytest.fail(STALE, pytrace=False)


def test_the_file_says_what_it_was_fitted_to() -> None:
    fitted = ["statements", "true", "brier_score", "expected_calibration_error"]
    numbers = ["intercept", "slope", "unexplained"]
    assert list(CONTENT) == ["made_by", "seeds", "kinds", "code", *numbers, *fitted]
    stored = Calibration(*(CONTENT[number] for number in numbers))
    assert (calibrated(0.3, 1.0), calibrated(0.3, 0.2)) == (stored(0.3), stored(0.3, 0.2))


@given(PROBABILITIES, st.floats(0.0, 0.9))
def test_a_name_is_less_sure_where_it_explains_less_of_the_error(probability: float, share: float) -> None:
    assert calibrated(probability, share) < calibrated(probability, share + 0.1)


@given(CALIBRATIONS, PROBABILITIES, PROBABILITIES, PROBABILITIES)
@example(Calibration(0.0, 1.0), 0.0, 1.0, 1.0)
def test_the_order_of_probabilities_is_kept(
    calibration: Calibration, first: float, second: float, share: float
) -> None:
    low, high = sorted((first, second))
    assert 0.0 < calibration(low, share) <= calibration(high, share) < 1.0
    if log_odds(high) - log_odds(low) > 1e-3:  # far above what rounding takes near 1
        assert calibration(low, share) < calibration(high, share)


@given(PROBABILITIES)
def test_the_identity_changes_only_what_nobody_can_know(probability: float) -> None:
    assert Calibration(0.0, 1.0)(probability) == pytest.approx(min(max(probability, 0.001), 0.999))


@pytest.mark.parametrize("slope", [0.0, -1.0, float("nan")])
def test_a_slope_that_would_turn_the_order_is_refused(slope: float) -> None:
    with pytest.raises(ValueError, match="must be above zero"):
        Calibration(0.0, slope)


@pytest.fixture
def engine(tmp_path: Path) -> Path:
    """A copy of the modules that decide a score."""
    for name in MODULES:
        if (file := PACKAGE / f"{name}.py").exists():
            (tmp_path / name).parent.mkdir(exist_ok=True)
            shutil.copy(file, tmp_path / f"{name}.py")
    return tmp_path


def test_the_hash_is_that_of_the_files_wherever_they_lie(engine: Path) -> None:
    assert hash_of_score(engine) == hash_of_score()
    (engine / "gap" / "name.py").write_text("VERDICT = 1\n")
    assert hash_of_score(engine) == hash_of_score()


@pytest.fixture
def prior(tmp_path: Path) -> Path:
    """Where a package of one module that decides a score has that module."""
    file = tmp_path / "gap" / "prior.py"
    file.parent.mkdir()
    return file


def test_words_do_not_make_it_stale(tmp_path: Path, prior: Path) -> None:
    prior.write_text(
        '"""Said."""\nWIDTH = 1.0\n"""Wide."""\n\ndef log(x):\n    """Return it."""\n    return x - 1\n'
    )
    before = hash_of_score(tmp_path)
    prior.write_text("WIDTH = 1.0  # why\n\n\ndef log(x):\n    return (x\n            - 1)\n")
    assert hash_of_score(tmp_path) == before


@pytest.mark.parametrize(
    "text",
    ["WIDTH = 1.1\n", "WIDTH = 1\n", "WIDTH = '1.0'\n", "WIDTH = -1.0\n", "HEIGHT = 1.0\n", "WIDTH = None\n"],
)
def test_every_other_change_makes_it_stale(tmp_path: Path, prior: Path, text: str) -> None:
    prior.write_text("WIDTH = 1.0\n")
    before = hash_of_score(tmp_path)
    prior.write_text(text)
    assert hash_of_score(tmp_path) != before
    prior.write_text("WIDTH = 1.0\n")
    prior.rename(prior.with_name("scales.py"))
    assert hash_of_score(tmp_path) != before


def test_the_hash_of_a_file_is_the_same_for_every_version_of_python(tmp_path: Path, prior: Path) -> None:
    """Versions differ in the fields of functions and classes, and in how empty ones are written."""
    text = "class A(B):\n    @c\n    def f(self, x: int = 1, *, y=None) -> str:\n        return f'{x!r:>{y}}' 'z'\n"
    prior.write_text(text)
    assert hash_of_score(tmp_path) == "e40b1d63023048e57187a3a965c8c3b239beae34fd13aef36876755770b6132b"


def test_the_stored_numbers_are_the_ones_that_are_used(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "calibration.yaml"
    file.write_text("intercept: -1.0\nslope: 0.5\nunexplained: 0.4\n")
    monkeypatch.setattr(calibration, "CALIBRATION", file)
    calibration._stored.cache_clear()
    try:
        assert calibrated(0.9, 0.5) == Calibration(-1.0, 0.5, 0.4)(0.9, 0.5) < 0.9
        file.unlink()
        assert calibrated(0.9, 0.5) < 0.9  # it was read once
    finally:
        calibration._stored.cache_clear()
