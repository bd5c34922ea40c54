"""Where runs are logged, in a checkout and in an installation."""

from pathlib import Path

import pytest

from simgap.artifacts import CHECKOUT
from simgap.errors import InputError
from simgap.runner.compose import compose
from simgap.tracking import Tracking, config, store

ROOT = Path(__file__).parents[3]


@pytest.fixture(params=[True, False], ids=["checkout", "installation"])
def in_checkout(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> bool:
    monkeypatch.chdir(tmp_path)
    if not request.param:
        monkeypatch.setattr(config, "CHECKOUT", None)
        monkeypatch.setattr(store, "PROJECT_ROOT", tmp_path)
    return request.param


def tracking(*overrides: str) -> Tracking:
    return Tracking(**compose(overrides)["tracking"])


def test_these_tests_run_in_a_checkout() -> None:
    assert CHECKOUT == ROOT


def test_by_default_a_checkout_alone_keeps_a_log(in_checkout: bool) -> None:
    assert Tracking().on is tracking().on is in_checkout


@pytest.mark.parametrize(
    "override", ["tracking=local", "tracking.uri=sqlite:///own.db", "tracking.enabled=true"]
)
def test_what_is_asked_for_is_done_anywhere(in_checkout: bool, override: str) -> None:
    assert tracking(override).on


@pytest.mark.parametrize("override", ["tracking=none", "tracking.enabled=false"])
def test_what_is_switched_off_is_off_whatever_the_address(in_checkout: bool, override: str) -> None:
    assert not tracking(override, "tracking.uri=sqlite:///own.db").on


def test_the_store_lies_where_a_person_works(in_checkout: bool, tmp_path: Path) -> None:
    folder = ROOT if in_checkout else tmp_path
    assert store.store_uri(tracking("tracking=local").uri) == f"sqlite:///{folder}/mlflow.db"


def test_a_log_that_was_asked_for_needs_its_library(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("simgap.extras.find_spec", lambda name: None)
    tracking().check()
    tracking("tracking=none", "tracking.uri=sqlite:///own.db").check()
    with pytest.raises(InputError, match="needs mlflow"):
        tracking("tracking=local").check()
