"""An MLflow store of one's own."""

from pathlib import Path

import pytest

from simgap.tracking.store import open_store


@pytest.fixture(scope="session")
def empty_store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Create a store once; that takes seconds."""
    path = tmp_path_factory.mktemp("store") / "runs.db"
    open_store(f"sqlite:///{path}")
    return path


@pytest.fixture
def store(empty_store: Path, tmp_path: Path) -> str:
    """Return the address of a store without runs."""
    (tmp_path / "runs.db").write_bytes(empty_store.read_bytes())
    return f"sqlite:///{tmp_path}/runs.db"
