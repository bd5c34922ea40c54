"""Cases in parallel processes. Each result is written atomically, so that an interrupted run continues."""

import json
import multiprocessing
import os
import threading
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from typing import Any

from simgap.artifacts import progress
from simgap.errors import InputError
from simgap.runner.threads import one_thread

RESULT = "result.json"

Work = Callable[[Any, Path], dict[str, Any]]


def run_cases(
    tasks: Mapping[str, Any], work: Work, folder: Path, jobs: int, identity: Callable[[Any], str]
) -> dict[str, dict[str, Any]]:
    """Run the tasks that have no result yet, and return all results by task name.

    Args:
        tasks: by name; each can be pickled.
        work: does a task in the folder that it may write to and returns its result, plain values alone.
        folder: holds one folder per task.
        jobs: processes side by side.
        identity: of a task; a result of another identity under the same name is done again, and so is one that
            `failed`.

    Raises:
        InputError: when a process was killed from outside.
    """
    results = {name: done for name, task in tasks.items() if (done := _done(folder / name, identity(task)))}
    missing = {name: task for name, task in tasks.items() if name not in results}
    for name, result in progress(_worked(missing, work, folder, jobs), "cases", len(missing)):
        results[name] = result | {"identity": identity(tasks[name])}
        write_whole(results[name], folder / name / RESULT)
    return {name: results[name] for name in tasks}


def _worked(
    tasks: Mapping[str, Any], work: Work, folder: Path, jobs: int
) -> Iterator[tuple[str, dict[str, Any]]]:
    if not tasks:
        return
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(min(jobs, len(tasks)), context, initializer=_start_worker) as pool:
        waiting = {pool.submit(work, task, folder / name): name for name, task in tasks.items()}
        try:
            for done in as_completed(waiting):
                yield waiting[done], done.result()
        except BrokenProcessPool as error:
            remedy = "start again: finished cases are kept (prove.jobs=1 needs less memory)"
            raise InputError("a process of the benchmark was killed", str(folder), remedy) from error
        finally:
            pool.shutdown(wait=False, cancel_futures=True)


def _start_worker() -> None:
    """Limit a worker process to one thread, and end it if its parent is killed."""
    one_thread()
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _done(folder: Path, identity: str) -> dict[str, Any] | None:
    path = folder / RESULT
    if not path.exists():
        return None
    result = json.loads(path.read_text(encoding="utf-8"))
    return result if result.get("identity") == identity and "failed" not in result else None


def write_whole(content: Any, path: Path) -> None:
    """Write JSON to a temporary name and rename it into place."""
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(f".{path.name}.{os.getpid()}")
    partial.write_text(json.dumps(content, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    partial.replace(path)
