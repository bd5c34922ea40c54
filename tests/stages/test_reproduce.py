"""Which recordings are used, and that it is said."""

from collections.abc import Callable
from pathlib import Path

import pytest

from simgap.errors import InputError
from simgap.recordings import registry
from simgap.runner import reproduction
from simgap.stages.reproduce import choose, reproduce, write_first_page
from tests.pipeline.report.artifacts import make_branch


@pytest.fixture
def place(monkeypatch: pytest.MonkeyPatch) -> Callable[[str | None], list[str]]:
    """Let published recordings come from a place; return what is fetched."""

    def put(origin: str | None) -> list[str]:
        fetched: list[str] = []
        monkeypatch.setattr(registry, "locate", lambda name, files: origin)
        monkeypatch.setattr(registry, "fetch", lambda name, files: fetched.append(name))
        return fetched

    return put


def test_real_recordings_are_preferred(place: Callable) -> None:
    assert place("SIMGAP_DATA") == []
    assert choose(None) == ("nanodrone", "real recordings from the folder that SIMGAP_DATA names")


def test_what_has_to_be_downloaded_is_downloaded_first(place: Callable) -> None:
    fetched = place("download")
    assert choose("swerve_drive") == ("swerve_drive", "real recordings, downloaded now")
    assert fetched == ["swerve_drive"]


def test_without_them_the_embedded_plant_is_flown(place: Callable) -> None:
    place(None)
    branch, reason = choose(None)
    assert branch == "embedded"
    assert "concealed plant" in reason
    assert "nanodrone: the recordings cannot be reached" in reason


def test_a_download_that_breaks_off_is_no_obstacle(place: Callable, monkeypatch: pytest.MonkeyPatch) -> None:
    place("download")

    def fail(name: str, files: list[str]) -> None:
        raise InputError("cannot be downloaded", name)

    monkeypatch.setattr(registry, "fetch", fail)
    assert choose(None)[0] == "embedded"


def test_recordings_that_were_asked_for_are_not_replaced(place: Callable) -> None:
    place(None)
    with pytest.raises(
        InputError, match="nanodrone: the recordings cannot be reached; connect to the network"
    ):
        choose("nanodrone")
    assert choose("embedded_null")[0] == "embedded_null"


def test_an_unknown_branch_is_one_line() -> None:
    with pytest.raises(InputError, match="did you mean 'nanodrone'"):
        choose("nanodron")


@pytest.mark.parametrize("code", [0, 1])
def test_the_diagnosis_is_shown_before_anything_is_trained(
    code: int, place: Callable, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    place("cache")
    targets: list[str] = []
    monkeypatch.setattr(reproduction, "reproduce_target", lambda target: targets.append(target) or code)
    monkeypatch.setattr(reproduction, "list_metrics", lambda: None)
    monkeypatch.setattr(
        "simgap.stages.reproduce.write_first_page", lambda artifacts, branch: artifacts / "first.html"
    )
    if code:
        with pytest.raises(InputError, match="did not finish"):
            reproduce("nanodrone")
    else:
        reproduce("nanodrone")
    said = capsys.readouterr().out
    assert targets == ["diagnose@nanodrone", "report@nanodrone"][: 2 - code]
    assert ("first.html" in said) == (code == 0)


def test_the_first_page_has_the_verdict_and_nothing_that_comes_after_it(tmp_path: Path) -> None:
    make_branch(tmp_path, "missing_physics")
    page = write_first_page(tmp_path, "nanodrone").read_text()
    assert "<title>nanodrone" in page
    assert 'id="verdict"' in page
    assert 'id="model"' not in page  # of the model that the branch has trained
