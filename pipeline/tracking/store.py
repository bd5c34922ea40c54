"""The MLflow store: opened late, created once even by processes that start together."""

import logging
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from simgap.artifacts import PROJECT_ROOT
from simgap.extras import named_extras

if TYPE_CHECKING:
    from mlflow import MlflowClient

EXPERIMENT = "simgap"

_SQLITE = "sqlite:///"
_LOCK_SECONDS = 60


def store_uri(uri: str | None) -> str:
    """Return the address of the store; a relative SQLite path starts in the checkout, else in the working directory."""
    if uri is None:
        return f"{_SQLITE}{PROJECT_ROOT / 'mlflow.db'}"
    return f"{_SQLITE}{PROJECT_ROOT / uri.removeprefix(_SQLITE)}" if uri.startswith(_SQLITE) else uri


def open_store(uri: str) -> "tuple[MlflowClient, str]":
    """Return a client of the store and the id of the project's experiment, made where they are not there.

    Raises:
        Exception: whatever MLflow and the system raise when the store cannot be used.
    """
    os.environ["MLFLOW_DISABLE_TELEMETRY"] = "true"
    with named_extras():
        from mlflow import MlflowClient

    for name in ("mlflow", "alembic"):
        logging.getLogger(name).setLevel(logging.WARNING)
    with locked(uri):
        path = _sqlite_path(uri)
        if path is not None and not path.exists():
            _create(path)
        client = MlflowClient(uri)
        experiment = client.get_experiment_by_name(EXPERIMENT)
        if experiment is not None:
            return client, experiment.experiment_id
        # MLflow stores absolute places of artifacts; without one it would be the working directory.
        artifacts = (path.parent / "mlartifacts").as_uri() if path is not None else None
        return client, client.create_experiment(EXPERIMENT, artifact_location=artifacts)


@contextmanager
def locked(uri: str) -> Iterator[None]:
    """Keep other processes from creating in a local store what this one is about to create."""
    path = _sqlite_path(uri)
    if path is None:
        yield
        return
    from filelock import FileLock

    with FileLock(f"{path}.lock", timeout=_LOCK_SECONDS):
        yield


def _sqlite_path(uri: str) -> Path | None:
    return Path(uri.removeprefix(_SQLITE)) if uri.startswith(_SQLITE) else None


def _create(path: Path) -> None:
    """Create the database under another name first: one that was killed half-made would never open again."""
    from mlflow.store.tracking.sqlalchemy_store import SqlAlchemyStore

    partial = path.with_name(f"{path.name}.partial")
    partial.unlink(missing_ok=True)
    try:
        store = SqlAlchemyStore(f"{_SQLITE}{partial}", (path.parent / "mlartifacts").as_uri())
        store.engine.dispose()
        partial.rename(path)
    finally:
        partial.unlink(missing_ok=True)
