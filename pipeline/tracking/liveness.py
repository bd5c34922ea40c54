"""Which process works on a run, so that a run whose process was killed does not stay open for ever."""

import os
import socket
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mlflow import MlflowClient
    from mlflow.entities import Run

PROCESS_TAG = "simgap.process"

_BOOT = Path("/proc/sys/kernel/random/boot_id")


def process() -> str:
    """Return what identifies this process: its machine, when that was started, and its number."""
    return f"{socket.gethostname()} {_boot()} {os.getpid()}"


def is_dead(tag: str) -> bool:
    """Whether a process of this machine has ended; of another machine's nothing is known."""
    host, boot, number = tag.rsplit(" ", 2)
    if host != socket.gethostname():
        return False
    if boot != _boot():
        return True
    try:
        os.kill(int(number), 0)
    except ProcessLookupError:
        return True
    except PermissionError:
        return False
    return False


def close_dead_runs(client: "MlflowClient", experiment: str) -> None:
    """Mark as killed the runs that are open and whose process has ended; they end when they last logged something."""
    for run in client.search_runs([experiment], "attributes.status = 'RUNNING'"):
        tag = run.data.tags.get(PROCESS_TAG)
        if tag is not None and is_dead(tag):
            client.set_terminated(run.info.run_id, "KILLED", _last_sign(client, run))


def _last_sign(client: "MlflowClient", run: "Run") -> int:
    """Return when a run last logged a metric, else when it began, ms since 1970."""
    logged = (
        entry.timestamp
        for name in run.data.metrics
        for entry in client.get_metric_history(run.info.run_id, name)
    )
    return max(logged, default=run.info.start_time)


def _boot() -> str:
    return _BOOT.read_text().strip() if _BOOT.exists() else "-"
