"""Where nothing compiles, the eager step flies, and it is said once."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

FLIGHT = """
import torch
from simgap.simulation.flight import racing_flight
from simgap.simulation.fused import FusedStep
from tests.pipeline.platforms.machines import QUADROTOR
from tests.pipeline.simulation.test_flight import actions, tumbling

flight = racing_flight(QUADROTOR, integrator="euler", substeps=1)
for batch in (5, 2000):  # small and large batches are compiled apart
    state, action = tumbling(batch, seed=1, dtype=torch.float32), actions(batch, seed=2, dtype=torch.float32)
    state, memory = flight.step(state, action)
    fused = FusedStep(flight.step, state, action, memory, repeats=2)
    rows = fused(fused.pack(state, memory), action.T.contiguous())
    for _ in range(2):
        state, memory = flight.step(state, action, memory)
    assert torch.equal(rows, fused.pack(state, memory))
"""
NUMBA = """
import numpy as np
from simgap.physics.play_steps import slips_in_play
print(slips_in_play(np.zeros(1), np.ones((1, 3)), np.zeros((1, 3)), 1.0, 0.5, 0.1))
"""
BROKEN = """#!/bin/sh
[ "$1" = --version ] && echo "g++ 12.2.0" && exit 0
echo "fatal error: Python.h: No such file or directory" >&2
exit 1
"""


def ran(code: str, folder: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run code with nothing compiled before and nothing on the path."""
    caches = {"TORCHINDUCTOR_CACHE_DIR": str(folder / "torch"), "NUMBA_CACHE_DIR": str(folder / "numba")}
    inherited = {name: value for name, value in os.environ.items() if name not in ("CC", "CXX")}
    (folder / "empty").mkdir()
    changed = {"PATH": str(folder / "empty"), **caches, **environment}
    command = [sys.executable, "-W", "ignore", "-c", code]
    root = Path(__file__).parents[4]
    return subprocess.run(
        command, cwd=root, env=inherited | changed, capture_output=True, text=True, check=False
    )


@pytest.mark.slow
def test_without_a_compiler_the_eager_step_flies(tmp_path: Path) -> None:
    done = ran(FLIGHT, tmp_path)
    assert (done.returncode, done.stderr.count("\n")) == (0, 1), done.stderr
    assert done.stderr.startswith("warning: no C++ compiler was found: ")
    assert "twice as long" in done.stderr


@pytest.mark.slow
def test_a_compiler_that_lacks_headers_is_no_compiler(tmp_path: Path) -> None:
    broken = tmp_path / "g++"
    broken.write_text(BROKEN)
    broken.chmod(0o755)
    done = ran(FLIGHT, tmp_path, CXX=str(broken))
    assert (done.returncode, done.stderr.count("\n")) == (0, 1), done.stderr
    assert done.stderr.startswith(f"warning: {broken} does not compile: ")


def test_numba_needs_no_compiler(tmp_path: Path) -> None:
    done = ran(NUMBA, tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
