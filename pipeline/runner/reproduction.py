"""`dvc repro`, which can be restarted after an interruption at any moment."""

import fcntl
import json
import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from simgap.artifacts import PROJECT_ROOT
from simgap.errors import InputError

_LOCK_FILE = "dvc.lock"
_DVC_STATE = Path(".dvc") / "tmp"


def list_metrics(root: Path = PROJECT_ROOT) -> None:
    """Tell `dvc metrics show` of the branches that have a report; it complains of every file that is not there.

    The list lies beside the artifacts, since it goes with them.
    """
    import yaml

    folder = root / "artifacts"
    found = sorted(path.relative_to(folder).as_posix() for path in folder.glob("*/report/metrics.json"))
    (folder / "dvc.yaml").write_text(yaml.safe_dump({"metrics": found}), encoding="utf-8")


def reproduce_target(target: str, root: Path = PROJECT_ROOT) -> int:
    """Run `dvc repro TARGET` and return its exit code.

    Raises:
        InputError: when the project's folder cannot be written.
    """
    with _alone(root) as lock:
        _mend(root)
        programs = Path(
            sys.executable
        ).parent  # the stages' commands are found there even without an activated .venv
        environment = os.environ | {
            "DVC_NO_ANALYTICS": "1",
            "PATH": f"{programs}{os.pathsep}{os.environ.get('PATH', '')}",
        }
        command = [sys.executable, "-m", "simgap.runner.quiet_dvc", "repro", target]
        # DVC inherits the lock: when only this process is killed, the next reproduction waits for DVC to end.
        return subprocess.run(command, cwd=root, env=environment, pass_fds=[lock], check=False).returncode


@contextmanager
def _alone(root: Path) -> Iterator[int]:
    """Hold the lock of reproductions; the system drops it with the last process that has it."""
    path = root / _DVC_STATE / "reproduce.lock"
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
    except OSError as error:
        raise InputError(
            f"cannot be written ({error.strerror})", str(path), "give it write rights"
        ) from error
    try:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            print("another reproduction is still running here: waiting for it to end", flush=True)
            fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield descriptor
    finally:
        os.close(descriptor)


def _mend(root: Path) -> None:
    """Remove what a killed DVC left half-written, and its claims on files, which outlive it."""
    lock_file = root / _LOCK_FILE
    if lock_file.exists() and not _is_whole(lock_file):
        print(f"{_LOCK_FILE} was left half-written: starting from what is cached", flush=True)
        lock_file.unlink()
    claims = root / _DVC_STATE / "rwlock"
    if claims.exists() and not _is_held(claims):
        claims.unlink()


def _is_whole(lock_file: Path) -> bool:
    import yaml
    from dvc.schema import COMPILED_LOCKFILE_SCHEMA
    from voluptuous import Invalid

    try:
        COMPILED_LOCKFILE_SCHEMA(yaml.safe_load(lock_file.read_text(encoding="utf-8")))
    except (yaml.YAMLError, UnicodeDecodeError, Invalid):
        return False
    return True


def _is_held(claims: Path) -> bool:
    """Whether a claim belongs to a DVC that still runs; its process number may have been reused."""
    try:
        modes = json.loads(claims.read_text(encoding="utf-8"))
        writers = list(modes.get("write", {}).values())
        readers = [reader for group in modes.get("read", {}).values() for reader in group]
        return any(_is_dvc(int(holder["pid"])) for holder in writers + readers)
    except (ValueError, KeyError, TypeError, AttributeError):
        return False


def _is_dvc(number: int) -> bool:
    import psutil

    try:
        return any("dvc" in word for word in psutil.Process(number).cmdline())
    except psutil.Error:
        return False
