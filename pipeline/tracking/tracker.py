"""One run of a stage as MLflow sees it: a child of its reproduction or of its sweep."""

import re
import sys
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from simgap.tracking.config import Tracking
from simgap.tracking.liveness import PROCESS_TAG, close_dead_runs, process
from simgap.tracking.store import locked, open_store, store_uri

if TYPE_CHECKING:
    from mlflow import MlflowClient

PARENT_TAG = "simgap.parent"
STAGE_TAG = "simgap.stage"

_LONGEST_VALUE = 500
_BATCH = 100


class Tracker:
    """Logs one run, and does nothing where tracking is switched off.

    The store is opened when the first value is logged, so that a stage that refuses its input leaves none; the run
    begins when its tracker is made.
    Tracking that cannot work warns once and lets the stage go on.
    """

    def __init__(
        self,
        settings: Tracking,
        stage: str,
        parent_name: str,
        parent_key: str,
        run_name: str | None = None,
        parameters: Mapping[str, Any] | None = None,
    ) -> None:
        """Describe the run; nothing is opened yet.

        Args:
            settings: where to log.
            stage: name of the stage.
            parent_name: what the reproduction or sweep is called.
            parent_key: identifies it: runs with the same key become children of one parent.
            run_name: what this run is called among its siblings; the stage's name when None.
            parameters: the resolved configuration.
        """
        self.settings = settings
        self.stage = stage
        self.parent_name = parent_name
        self.parent_key = parent_key
        self.run_name = run_name or stage
        self.parameters = dict(parameters or {})
        self._inputs: dict[str, str] = {}
        self._client: MlflowClient | None = None
        self._experiment = self._parent = self._run = ""
        self._started = _now()
        self._silent = not settings.on

    @classmethod
    def none(cls) -> "Tracker":
        """Return a tracker that does nothing."""
        return cls(Tracking(enabled=False), "", "", "")

    @property
    def uri(self) -> str:
        """The address of the store, for a library that logs by itself."""
        return store_uri(self.settings.uri)

    def run_id(self) -> str | None:
        """Return the id of this run, started now if need be; None where there is no tracking."""
        self._attempt(lambda client: None)
        return None if self._silent else self._run

    def log_input(self, path: str, digest: str) -> None:
        """Tag the run with the hash of an input."""
        self._inputs[path] = digest
        if self._run:
            self._attempt(lambda client: client.set_tag(self._run, _tag_name(path), digest))

    def log_metrics(self, metrics: Mapping[str, float], step: int | None = None) -> None:
        """Log numbers of this run."""
        self._attempt(lambda client: _log_metrics(client, self._run, metrics, step))

    def log_results(self, metrics: Mapping[str, float]) -> None:
        """Log numbers of the parent."""
        self._attempt(lambda client: _log_metrics(client, self._parent, metrics, None))

    def describe(self, tags: Mapping[str, str]) -> None:
        """Tag the run and its parent with what came out, in words: MLflow shows tags as columns."""

        def set_tags(client: "MlflowClient") -> None:
            for run in (self._run, self._parent):
                for name, text in tags.items():
                    client.set_tag(run, _allowed(name), text[:_LONGEST_VALUE])

        self._attempt(set_tags)

    def log_figure(self, figure: Any, name: str) -> None:
        """Log a matplotlib figure as a picture."""
        self._attempt(lambda client: client.log_figure(self._run, figure, f"{name}.png"))

    def log_folder(self, folder: Path) -> None:
        """Log the files of a folder under its name."""
        self._attempt(lambda client: client.log_artifacts(self._run, str(folder), folder.name))

    def finish(self, succeeded: bool, killed: bool = False) -> None:
        """Close the run and its parent; a run that failed before anything was logged is not opened for it.

        Args:
            succeeded: whether the stage has done its work.
            killed: whether it was interrupted, where it has not.
        """
        if not (self._run or succeeded):
            return
        status = "FINISHED" if succeeded else "KILLED" if killed else "FAILED"
        self._attempt(lambda client: client.set_terminated(self._run, status))
        self._attempt(lambda client: client.set_terminated(self._parent, status))

    def _attempt(self, action: "Callable[[MlflowClient], object]") -> None:
        if self._silent:
            return
        try:
            if self._client is None:
                self._client = self._start()
            action(self._client)
        except Exception as error:  # tracking is a convenience: whatever ails it, the stage goes on
            self._silent = True
            reason = (str(error).strip().splitlines() or [type(error).__name__])[0]
            print(f"warning: this run is not tracked in {self.uri}: {reason}", file=sys.stderr, flush=True)

    def _start(self) -> "MlflowClient":
        client, self._experiment = open_store(self.uri)
        with locked(self.uri):
            close_dead_runs(client, self._experiment)
            self._parent = self._open_parent(client)
        self._run = self._begin(client)
        return client

    def _open_parent(self, client: "MlflowClient") -> str:
        """Return the parent, open; one that holds this run's earlier self alone is made anew, for its times."""
        tag = {PARENT_TAG: self.parent_key}
        parent = self._find(client, tag)
        if parent and self._is_repeated(client, parent):
            parent = None
        if parent is None:
            return self._create(client, self.parent_name, tag)
        client.update_run(parent, "RUNNING")
        client.set_tag(parent, PROCESS_TAG, process())
        return parent

    def _is_repeated(self, client: "MlflowClient", parent: str) -> bool:
        """Whether this run is all that a parent holds; both are deleted then."""
        children = client.search_runs([self._experiment], f"tags.`mlflow.parentRunId` = '{parent}'")
        names = {(run.data.tags.get(STAGE_TAG), run.info.run_name) for run in children}
        repeated = names == {(self.stage, self.stage)}  # a job of a sweep has a name of its own
        for run in [*(child.info.run_id for child in children), parent] if repeated else []:
            client.delete_run(run)
        return repeated

    def _begin(self, client: "MlflowClient") -> str:
        """Return a new run; parameters cannot change, so it takes the place of an earlier one of its name."""
        earlier = self._earlier(client)
        if earlier:
            client.delete_run(earlier)
        tags = {"mlflow.source.name": f"simgap {self.stage}"} | self._siblings()
        hashes = {_tag_name(path): digest for path, digest in self._inputs.items()}
        run = self._create(client, self.run_name, tags | hashes)
        _log_parameters(client, run, self.parameters)
        return run

    def _earlier(self, client: "MlflowClient") -> str | None:
        return self._find(client, self._siblings() | {"mlflow.runName": self.run_name})

    def _siblings(self) -> dict[str, str]:
        return {"mlflow.parentRunId": self._parent, STAGE_TAG: self.stage}

    def _find(self, client: "MlflowClient", tags: Mapping[str, str]) -> str | None:
        condition = " and ".join(f"tags.`{key}` = '{value}'" for key, value in tags.items())
        runs = client.search_runs([self._experiment], condition, max_results=1)
        return runs[0].info.run_id if runs else None

    def _create(self, client: "MlflowClient", name: str, tags: Mapping[str, str]) -> str:
        known = {**tags, PROCESS_TAG: process()}
        return client.create_run(self._experiment, self._started, known, name).info.run_id


def _log_metrics(client: "MlflowClient", run: str, metrics: Mapping[str, float], step: int | None) -> None:
    from mlflow.entities import Metric

    now = _now()
    entries = [Metric(_allowed(name), value, now, step or 0) for name, value in metrics.items()]
    for start in range(0, len(entries), _BATCH):
        client.log_batch(run, metrics=entries[start : start + _BATCH])


def _log_parameters(client: "MlflowClient", run: str, parameters: Mapping[str, Any]) -> None:
    from mlflow.entities import Param

    entries = [Param(_allowed(key), value[:_LONGEST_VALUE]) for key, value in _flat(parameters).items()]
    for start in range(0, len(entries), _BATCH):
        client.log_batch(run, params=entries[start : start + _BATCH])


def _flat(values: Mapping[str, Any], prefix: str = "") -> dict[str, str]:
    flat: dict[str, str] = {}
    for key, value in values.items():
        if isinstance(value, Mapping):
            flat |= _flat(value, f"{prefix}{key}.")
        else:
            flat[f"{prefix}{key}"] = str(value)
    return flat


def _now() -> int:
    """Return the time in ms since 1970, as MLflow counts it."""
    return int(time.time() * 1000)


def _tag_name(path: str) -> str:
    return _allowed(f"input.{Path(path).as_posix()}")


def _allowed(name: str) -> str:
    """Return the name in the characters and the length that MLflow takes."""
    return re.sub(r"[^\w.\-:/ ]", "_", name)[-250:]
