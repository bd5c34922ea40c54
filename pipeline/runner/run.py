"""The context of a running stage: output folder, inputs, metrics, figures and messages."""

import json
import logging
import math
import os
import sys
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, TypeVar

from simgap.artifacts import hash_path, progress
from simgap.artifacts.project import STAGES
from simgap.errors import InputError
from simgap.tracking import Tracker

Item = TypeVar("Item")

METRICS_FILE = "metrics.json"


class StageRun:
    """One run of a stage.

    Attributes:
        output: the directory to write into; it takes its final place when the stage returns.
        inputs: SHA-256 of every input, by path.
        metrics: the last value of every metric that was logged without a step.
        warnings: what was warned of, in order.
    """

    def __init__(self, output: str | Path, tracker: Tracker | None = None) -> None:
        """Write into `output`, which is there, and log with `tracker`, if any."""
        self.output = Path(output)
        self.tracker = tracker or Tracker.none()
        self.inputs: dict[str, str] = {}
        self.metrics: dict[str, float] = {}
        self.warnings: list[str] = []

    def input(self, path: str | Path) -> Path:
        """Return the path of an input that exists; its hash is logged.

        Raises:
            InputError: when the path is not there or cannot be read.
        """
        path = Path(path)
        if not path.exists():
            raise InputError("does not exist", str(path), _how_to_get(path))
        self.inputs[str(path)] = hash_path(path)
        self.tracker.log_input(str(path), self.inputs[str(path)])
        return path

    def log_metrics(self, metrics: Mapping[str, float | int], step: int | None = None) -> None:
        """Log numbers; those without a step are also written to `metrics.json` of the output."""
        values = {name: float(value) for name, value in metrics.items()}
        if step is None:
            self.metrics |= values
        self.tracker.log_metrics(values, step)

    def log_results(self, metrics: Mapping[str, float]) -> None:
        """Log the final numbers of the whole reproduction to the parent of the stages' runs."""
        self.tracker.log_results({name: float(value) for name, value in metrics.items()})

    def describe(self, tags: Mapping[str, str]) -> None:
        """Tag the run and its reproduction with what came out, in words."""
        self.tracker.describe(tags)

    def log_figure(self, figure: Any, name: str) -> None:
        """Log a matplotlib figure under a name without suffix."""
        self.tracker.log_figure(figure, name)

    def say(self, text: str) -> None:
        """Print a result in one line."""
        logging.getLogger("simgap").info("%s", " ".join(text.split()))

    def warn(self, text: str) -> None:
        """Print a warning in one line on standard error; the same one is not repeated."""
        line = " ".join(text.split())
        if line in self.warnings:
            return
        self.warnings.append(line)
        print(f"warning: {line}", file=sys.stderr, flush=True)

    def progress(self, iterable: Iterable[Item], label: str, total: int | None = None) -> Iterator[Item]:
        """Yield the items and show how far the work is; see `simgap.artifacts.progress`."""
        return progress(iterable, label, total)

    def leave_out(self, reason: str) -> None:
        """Report why the stage has nothing to do, and write empty metrics for the stages that follow."""
        self.say(reason)
        (self.output / METRICS_FILE).write_text("{}\n")

    def write_metrics(self) -> None:
        """Write the metrics beside the other output, unless the stage wrote such a file itself."""
        path = self.output / METRICS_FILE
        if self.metrics and not path.exists():
            plain = {key: value if math.isfinite(value) else None for key, value in self.metrics.items()}
            path.write_text(json.dumps(plain, indent=2, sort_keys=True) + "\n")


def in_pipeline() -> bool:
    """Whether DVC runs the stage as a part of a branch: then a stage without work writes empty metrics for the others.

    DVC says so in the environment of every command that it runs.
    """
    return bool(os.environ.get("DVC_STAGE"))


def _how_to_get(path: Path) -> str:
    """Return what to do about an input that is not there: another path, or the stage in whose folder it would be.

    The innermost such folder counts: those around it are a person's own.
    """
    writers = [part for part in path.parts if not part.startswith("_") and (STAGES / f"{part}.py").exists()]
    return f"check the path, or run simgap {writers[-1]} first" if writers else "check the path"


def read_metrics(output: Path) -> dict[str, Any]:
    """Return the metrics that a stage has written; none where it has not."""
    path = output / METRICS_FILE
    return json.loads(path.read_text()) if path.exists() else {}
