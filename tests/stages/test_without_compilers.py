"""The stages that compile, with every compiler hidden from the path."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from simgap.artifacts import PROJECT_ROOT
from tests.stages.racing import FEW


def ran(stage: str, artifacts: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-W", "ignore", "-m", "simgap.stages", stage, *FEW, f"artifacts={artifacts}"]
    command += ["evaluate.starts=3", "evaluate.seconds=0.5"]
    inherited = {name: value for name, value in os.environ.items() if name not in ("CC", "CXX")}
    changed = {"OMP_NUM_THREADS": "1", **environment}
    return subprocess.run(
        command, cwd=PROJECT_ROOT, env=inherited | changed, capture_output=True, text=True, check=False
    )


def first_updates(artifacts: Path) -> list[dict[str, float]]:
    return json.loads((artifacts / "train_policy" / "curve.json").read_text())[:3]


@pytest.mark.slow(minutes=1)
def test_a_policy_is_trained_and_flown_without_a_compiler(trained: Path, tmp_path: Path) -> None:
    """As with one. Rounding differs, and grows from update to update: the first ones are compared."""
    (tmp_path / "empty").mkdir()
    hidden = {"PATH": str(tmp_path / "empty"), "TORCHINDUCTOR_CACHE_DIR": str(tmp_path / "cache")}
    for stage in ("train_policy", "evaluate"):
        done = ran(stage, tmp_path / "eager", **hidden)
        warnings = [line for line in done.stderr.splitlines() if line.startswith("warning: ")]
        assert done.returncode == 0, done.stderr
        assert len([line for line in warnings if "no C++ compiler was found" in line]) == 1
        assert "Traceback" not in done.stderr
    pairs = list(zip(first_updates(tmp_path / "eager"), first_updates(trained), strict=True))
    # Up to here no sample is moved over the limit of the clipping; a count of samples jumps, where all else is smooth.
    for eager, compiled in pairs[:2]:
        assert eager["clip_fraction"] == pytest.approx(compiled["clip_fraction"], abs=1e-3)
    for eager, compiled in pairs:
        smooth = eager.keys() - {"clip_fraction"}
        assert {name: eager[name] for name in smooth} == pytest.approx(
            {name: compiled[name] for name in smooth}, rel=1e-3, abs=1e-3
        )
