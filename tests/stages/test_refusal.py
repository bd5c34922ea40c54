"""What it costs to be told that a recording cannot be used."""

import resource
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pandas as pd
import pytest

from tests.pipeline.gap.recordings import Plant, joint_recording

HEAVY = (
    "import hydra, pandas, pyarrow, torch"  # a refusal takes some 0.6 of the processor time of these imports
)
LAST_WORDS = """
import sys
from simgap.stages.__main__ import main
try:
    main()
finally:
    print(*sorted({"torch", "scipy", "mlflow", "numba"} & set(sys.modules)))
"""
ARGUMENTS = ("platform=servo", "recording=bad.csv", "output=answer", "tracking=none")


def _missing(frame: pd.DataFrame, path: Path) -> None:
    frame.drop(columns="position").to_csv(path, index=False)


def _garbage(frame: pd.DataFrame, path: Path) -> None:
    path.write_bytes(bytes(range(256)) * 1000)


def _without_values(frame: pd.DataFrame, path: Path) -> None:
    frame.assign(position=float("nan"), velocity=float("nan")).to_csv(path, index=False)


def _absent(frame: pd.DataFrame, path: Path) -> None:
    pass


@pytest.fixture(scope="module")
def heavy() -> float:
    """Return the processor time of a process that imports what a fit needs, s: a peer of the same machine and hour."""
    before = _seconds()
    subprocess.run([sys.executable, "-c", HEAVY], check=True)
    return _seconds() - before


@pytest.mark.parametrize(
    ("stage", "spoil", "words"),
    [
        ("diagnose", _missing, "column 'position' is missing"),
        ("diagnose", _garbage, "is not a text file"),
        ("diagnose", _without_values, "column 'position': has no values"),
        ("diagnose", _absent, "does not exist"),
        ("clean", _missing, "column 'position' is missing"),
    ],
)
def test_a_refusal_comes_before_anything_heavy(
    tmp_path: Path, heavy: float, stage: str, spoil: Callable[[pd.DataFrame, Path], None], words: str
) -> None:
    spoil(joint_recording(Plant(friction=0.3), runs=4).frame, tmp_path / "bad.csv")
    before = _seconds()
    done = subprocess.run(
        [sys.executable, "-c", LAST_WORDS, stage, *ARGUMENTS],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    taken = _seconds() - before
    assert (done.returncode, done.stdout) == (2, "\n"), "something heavy was imported"
    assert words in done.stderr
    assert done.stderr.count("\n") == 1
    assert not (tmp_path / "answer").exists()
    assert taken < heavy


def test_the_package_itself_costs_nothing() -> None:
    code = "import sys, simgap; print(*{'numpy', 'pandas', 'torch', 'hydra', 'gymnasium'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "\n"


def _seconds() -> float:
    """Return the processor time of all children so far."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime
