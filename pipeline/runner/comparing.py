"""Comparison of the jobs of a sweep: a table and a figure, in the folder of the sweep and in MLflow."""

import logging
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from simgap.artifacts import staged_directory
from simgap.comparison.comparison import Comparison, Job, Metrics
from simgap.runner.completion import Note
from simgap.runner.place import Place
from simgap.runner.run import read_metrics
from simgap.tracking import SweepTracker

if TYPE_CHECKING:
    from simgap.runner.config import StageConfig
    from simgap.runner.wrapper import Stage

FOLDER = "comparison"
TABLES = "comparison.md"

_log = logging.getLogger("simgap")


@dataclass(frozen=True)
class Done:
    """A job that succeeded.

    Attributes:
        place: of the job in its sweep.
        config: of the stage.
        folder: that it wrote.
    """

    place: Place
    config: "StageConfig"
    folder: Path


@dataclass(frozen=True)
class Failed:
    """A job that failed.

    Attributes:
        mistake: which, and why.
    """

    mistake: str


def write_comparison(stage: "Stage[Any]", outcomes: Sequence[Done | Failed], command: str) -> Path | None:
    """Compare the jobs that succeeded; return the folder, or None if there is nothing to compare.

    Args:
        stage: whose jobs they are.
        outcomes: of all jobs.
        command: that made them.
    """
    from simgap.comparison.figure import FIGURE, draw
    from simgap.comparison.page import tables_text

    done = [outcome for outcome in outcomes if isinstance(outcome, Done)]
    jobs, references, machines = _read(stage, done)
    if not any(job.metrics for job in jobs):
        return None
    first = done[0]
    failed = [outcome.mistake for outcome in outcomes if isinstance(outcome, Failed)]
    comparison = Comparison(
        first.place.folder, command, "; ".join(machines), jobs, references, failed, first.config.results
    )
    target = first.folder.parent / FOLDER
    with staged_directory(target, owned=True) as output:
        comparison.write(output)
        draw(comparison, output / FIGURE)
        (output / TABLES).write_text(tables_text(comparison), encoding="utf-8")
    tracker = SweepTracker(first.config.tracking, stage.name, "", first.place.sweep)
    tracker.log_folder(target)
    _log.info("%s: wrote %s", stage.name, target)
    return target


def _read(stage: "Stage[Any]", done: Sequence[Done]) -> tuple[list[Job], dict[str, Metrics], dict[str, None]]:
    """Return the jobs, what all of them are held against, and the machines that ran them."""
    jobs: list[Job] = []
    references: dict[str, Metrics] = {}
    machines: dict[str, None] = {}  # in their order, each once
    for outcome in done:
        note = Note.read(outcome.folder)
        assert note is not None
        compared = stage.compared(read_metrics(outcome.folder))
        values = {key: value for key, value in outcome.place.values.items() if key != "seed"}
        jobs.append(Job(values, note.seed, compared.pop("", {}), note.seconds))
        references |= compared
        machines |= {note.machine: None}
    return jobs, references, machines
