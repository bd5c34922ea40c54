"""What the shell proposes, asked as bash asks."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from simgap.artifacts.project import CONFIGURATION
from simgap.runner.project import commands
from simgap.runner.shell_completion import candidates, script

PROGRAMS = Path(sys.executable).parent
# The line is what was typed up to the cursor; bash itself splits it at its word breaks.
IN_BASH = """
eval "$(simgap --completion bash)"
COMP_LINE=$1
COMP_POINT=${#COMP_LINE}
_simgap
printf '%s\\n' "${COMPREPLY[@]}"
"""


def in_bash(line: str) -> list[str]:
    environment = os.environ | {"PATH": f"{PROGRAMS}{os.pathsep}{os.environ['PATH']}"}
    command = ["bash", "-c", IN_BASH, "bash", line]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    assert done.stderr == ""
    return done.stdout.split()


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("simgap diag", ["diagnose"]),
        ("simgap reproduce swerve_d", ["swerve_drive", "swerve_drive_sim"]),
        ("simgap diagnose platf", ["platform="]),
        ("simgap diagnose branch=embedded trac", ["tracking.", "tracking="]),
        # Bash puts what comes back behind the equals sign.
        ("simgap diagnose platform=ra", ["racer"]),
        ("simgap train_policy branch=embedded train_policy.learning.hor", ["train_policy.learning.horizon="]),
        ("simgap train --cf", ["--cfg"]),
        ("simgap nonsense ", []),
    ],
)
def test_bash_completes_a_line(line: str, expected: list[str]) -> None:
    assert in_bash(line) == expected


def test_every_command_is_proposed() -> None:
    assert candidates([""]) == list(commands())


def test_every_platform_is_proposed() -> None:
    names = sorted(path.stem for path in (CONFIGURATION / "platform").glob("*.yaml"))
    assert candidates(["diagnose", "platform="]) == [f"platform={name}" for name in names]


def test_a_platform_of_ones_own_is_proposed(tmp_path: Path) -> None:
    (tmp_path / "platform").mkdir()
    (tmp_path / "platform" / "my_arm.yaml").write_text("kind: joint\n")
    assert candidates(["diagnose", "--config-dir", str(tmp_path), "platform=my"]) == ["platform=my_arm"]


def test_only_what_a_stage_reads_is_proposed() -> None:
    assert candidates(["clean", "deploy"]) == []
    assert candidates(["train", "experiment"]) == []
    assert candidates(["train", "+exp"]) == ["+experiment="]


def test_a_line_with_a_mistake_is_answered_with_nothing() -> None:
    assert candidates(["train", "branch=none_such", "se"]) == []


@pytest.mark.parametrize(("shell", "check"), [("bash", "-n"), ("zsh", "-n"), ("fish", "--no-execute")])
def test_the_script_is_one_of_its_shell(shell: str, check: str, tmp_path: Path) -> None:
    text = script(shell)
    assert "--complete " in text
    if shutil.which(shell):
        path = tmp_path / f"completion.{shell}"
        path.write_text(text)
        done = subprocess.run([shell, check, str(path)], capture_output=True, text=True, check=False)
        assert (done.returncode, done.stderr) == (0, "")


def test_another_shell_is_refused_in_one_line() -> None:
    command = [str(PROGRAMS / "simgap"), "--completion", "fihs"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert (
        done.stderr == "simgap --completion: 'fihs': is no shell that is known here; did you mean 'fish'?\n"
    )
