"""Commands where the library of an extra is not installed, and where none is."""

import subprocess
import sys
from pathlib import Path

import pytest

from simgap.recordings.recording import write_recording
from tests.pipeline.gap.recordings import Plant, joint_recording

EXTRA = ("casadi", "cv2", "dvc", "filelock", "filterpy", "gpytorch", "gymnasium", "matplotlib", "mlflow")
EXTRA += ("onnx", "pytorch_lightning", "sklearn", "tensordict", "torchrl")
WITHOUT = (
    "import sys; sys.modules |= dict.fromkeys({hidden}); from simgap.stages.__main__ import main; main()"
)
OWN = ("platform=servo", "recording=bench.parquet")
RACE = ("platform=racer", "track=tiny", "train_policy=racing_quick")


def command_without(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run a command where no library of an extra can be imported."""
    return subprocess.run(
        [sys.executable, "-c", WITHOUT.format(hidden=EXTRA), *arguments],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.fixture
def bench(tmp_path: Path) -> Path:
    """A folder with a recording of a joint."""
    write_recording(joint_recording(Plant(friction=0.3), runs=4), tmp_path / "bench.parquet")
    return tmp_path


@pytest.mark.parametrize(
    ("arguments", "library", "extra"),
    [
        (("train", "recording=bench.parquet"), "pytorch-lightning", "learn"),
        (("train_policy", *RACE), "tensordict", "race"),
        (("profile", "platform=swerve_shuttle"), "casadi", "race"),
        (("diagnose", *OWN, "tracking=local"), "mlflow", "track"),
        (("clean", *OWN, "-m", "seed=1,2"), "matplotlib", "sweep"),
    ],
)
def test_a_command_says_which_extra_it_needs(bench: Path, arguments, library, extra) -> None:
    untracked = () if "tracking=local" in arguments else ("tracking=none",)
    done = command_without(bench, *arguments, *untracked, "output=out")
    *warnings, line = done.stderr.splitlines()
    assert all(warning.startswith("warning: ") for warning in warnings)
    assert line == f"simgap {arguments[0]}: needs {library}; pip install 'simgap[{extra}]'"
    assert done.returncode == 2
    assert [path.name for path in bench.iterdir()] == ["bench.parquet"]
