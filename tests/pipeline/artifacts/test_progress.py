import itertools
import logging
import sys

import pytest

from simgap.artifacts import Pace, progress

clock_module = sys.modules[progress.__module__]


class Clock:
    """Every look at it takes a second."""

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        self.now += 1.0
        return self.now


def test_long_work_without_a_terminal_is_told_in_lines(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(clock_module.time, "monotonic", Clock())
    with caplog.at_level(logging.INFO, logger="simgap"):
        assert list(progress(range(30), "flying")) == list(range(30))
    lines = [record.getMessage() for record in caplog.records]
    assert lines == [
        "flying: 1 of 30 after 2 s, about 58 s left",
        "flying: 11 of 30 after 12 s, about 21 s left",
        "flying: 21 of 30 after 22 s, about 9 s left",
    ]


def test_what_takes_long_is_told_in_minutes_and_what_has_no_end_without(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(clock_module.time, "monotonic", Clock())
    with caplog.at_level(logging.INFO, logger="simgap"):
        list(itertools.islice(progress(range(600), "flying"), 3))
        list(itertools.islice(progress(iter(range(600)), "flying"), 3))
    lines = [record.getMessage() for record in caplog.records]
    assert lines == ["flying: 1 of 600 after 2 s, about 20 min left", "flying: 1 after 2 s"]


def test_short_work_says_nothing(
    caplog: pytest.LogCaptureFixture, capsys: pytest.CaptureFixture[str]
) -> None:
    with caplog.at_level(logging.INFO, logger="simgap"):
        assert list(progress((n for n in range(3)), "flying")) == [0, 1, 2]
    assert not caplog.records
    assert capsys.readouterr() == ("", "")


def test_a_terminal_gets_a_bar(monkeypatch: pytest.MonkeyPatch) -> None:
    import tqdm

    seen: dict = {}

    def bar(iterable: object, **keywords: object) -> object:
        seen.update(keywords)
        return iterable

    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    monkeypatch.setattr(tqdm, "tqdm", bar)
    assert list(progress(iter("ab"), "flying", total=2)) == ["a", "b"]
    assert (seen["desc"], seen["total"], seen["delay"]) == ("flying", 2, 2.0)


def test_work_of_unknown_length_says_where_it_is_every_ten_seconds(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(clock_module.time, "monotonic", Clock())
    pace = Pace("flying")
    with caplog.at_level(logging.INFO, logger="simgap"):
        for lap in range(25):
            pace.tell(f"lap {lap}")
    lines = [record.getMessage() for record in caplog.records]
    assert lines == ["flying: lap 9 after 10 s", "flying: lap 19 after 20 s"]
