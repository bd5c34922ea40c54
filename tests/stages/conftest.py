"""A policy that several stages fly, trained once."""

from pathlib import Path

import pytest

from simgap.stages.train_policy import train_policy
from tests.stages.racing import FEW, ran


@pytest.fixture(scope="session")
def trained(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the artifacts of a training that is far too short."""
    artifacts = tmp_path_factory.mktemp("artifacts")
    ran(train_policy, *FEW, f"artifacts={artifacts}")
    return artifacts
