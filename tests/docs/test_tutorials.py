"""Each tutorial runs as a person runs it: as a script, in a folder of its own. It asserts what it says."""

import os
import subprocess
import sys

import pytest

from simgap.artifacts import PROJECT_ROOT

TUTORIALS = sorted((PROJECT_ROOT / "docs" / "tutorials").glob("*.py"))


@pytest.mark.slow
@pytest.mark.parametrize("tutorial", TUTORIALS, ids=lambda path: path.stem)
def test_a_tutorial_runs(tutorial, tmp_path):
    environment = {**os.environ, "MPLBACKEND": "Agg", "OMP_NUM_THREADS": "1"}
    command = [sys.executable, str(tutorial)]
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
