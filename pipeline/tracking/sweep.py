"""What else a sweep logs: jobs that were done before, and what all of its jobs have shown."""

from typing import TYPE_CHECKING

from simgap.tracking.tracker import Tracker

if TYPE_CHECKING:
    from mlflow import MlflowClient


class KeptTracker(Tracker):
    """Logs a job that was done before: as the run that it then was, as a new one only where the sweep has none."""

    def _begin(self, client: "MlflowClient") -> str:
        return self._earlier(client) or super()._begin(client)


class SweepTracker(Tracker):
    """Logs to the parent of the jobs."""

    def _begin(self, client: "MlflowClient") -> str:
        return self._parent
