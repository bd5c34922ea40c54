"""Every tutorial runs from start to end, in a folder of its own; it asserts itself what it promises."""

import runpy
from pathlib import Path

import pytest

# The one on the Python interface runs on an installed wheel: tests/test_wheel.py.
FOLDER = Path(__file__).parents[2] / "docs" / "tutorials"
TUTORIALS = sorted(path for path in FOLDER.glob("*.py") if path.stem != "api")


@pytest.mark.slow
@pytest.mark.parametrize("script", TUTORIALS, ids=lambda path: path.stem)
def test_a_tutorial_runs(script, tmp_path, monkeypatch):
    """As a program of its own would, but for the imports that this process has paid for."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    runpy.run_path(str(script), run_name="__main__")


def test_there_are_tutorials():
    assert TUTORIALS
