"""A policy that several stages fly, trained once."""

import os
import shutil
from pathlib import Path

import pytest
from filelock import FileLock

from simgap.stages.train_policy import train_policy
from tests.stages.racing import FEW, ran


@pytest.fixture(scope="session")
def trained(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the artifacts of a training that is far too short: workers beside each other share it, each has a copy."""
    own = tmp_path_factory.mktemp("artifacts")
    parallel = "PYTEST_XDIST_WORKER" in os.environ
    shared = tmp_path_factory.getbasetemp().parent / "trained" if parallel else own
    with FileLock(f"{shared}.lock"):
        if not (shared / "train_policy").exists():
            ran(train_policy, *FEW, f"artifacts={shared}")
    if parallel:
        shutil.copytree(shared, own, dirs_exist_ok=True)
    return own
