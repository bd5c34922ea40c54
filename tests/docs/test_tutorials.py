"""Every tutorial runs from start to end, in a folder of its own; it asserts itself what it promises."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

# The one on the Python interface runs on an installed wheel: tests/test_wheel.py.
FOLDER = Path(__file__).parents[2] / "docs" / "tutorials"
TUTORIALS = sorted(path for path in FOLDER.glob("*.py") if path.stem != "api")


@pytest.mark.slow
@pytest.mark.parametrize("script", TUTORIALS, ids=lambda path: path.stem)
def test_a_tutorial_runs(script, tmp_path):
    done = subprocess.run(
        [sys.executable, str(script)],
        cwd=tmp_path,
        env=os.environ | {"MPLBACKEND": "Agg"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr


def test_there_are_tutorials():
    assert TUTORIALS
