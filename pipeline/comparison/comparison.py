"""The metrics of a sweep's jobs, and the file that stores them."""

import json
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from simgap.comparison.settings import Results, TableOf
from simgap.errors import InputError

SCHEMA = "simgap.comparison/1"
FILE = "comparison.json"

Value = int | float | str | bool | None
Metrics = dict[str, float | None]
Compared = Callable[[Mapping[str, Any]], dict[str, Metrics]]
"""Selects the metrics to compare from those that a stage has written: the job's own under "", and those of references
under other names."""


@dataclass(frozen=True)
class Job:
    """One job of a sweep.

    Attributes:
        values: swept values, without the seed.
        seed: seed of the random draws.
        metrics: metrics by name; None for one that is not finite.
        seconds: duration, s.
    """

    values: dict[str, Value]
    seed: int
    metrics: Metrics
    seconds: float = 0.0


@dataclass(frozen=True)
class Comparison:
    """The results of a sweep.

    Attributes:
        name: name of the sweep: its preset or its stage.
        command: the command that ran it.
        machine: the machine that ran it.
        jobs: the successful jobs.
        references: metrics of the references, such as persistence, by name.
        failed: one sentence for each failed job.
        results: layout of tables, figure and text.
    """

    name: str
    command: str
    machine: str
    jobs: list[Job]
    references: dict[str, Metrics] = field(default_factory=dict)
    failed: list[str] = field(default_factory=list)
    results: Results = field(default_factory=Results)

    def write(self, folder: Path) -> None:
        """Write `comparison.json`."""
        text = json.dumps({"schema": SCHEMA} | asdict(self), indent=1, ensure_ascii=False)
        (folder / FILE).write_text(text + "\n", encoding="utf-8")

    @classmethod
    def read(cls, folder: Path) -> "Comparison":
        """Read what `write` wrote.

        Raises:
            InputError: when there is no such file, or it is something else.
        """
        path = folder / FILE
        try:
            content = json.loads(path.read_text(encoding="utf-8"))
            if content.pop("schema") != SCHEMA:
                raise ValueError("of another schema")
            laid_out = content.pop("results")
            laid_out["tables"] = [TableOf(**table) for table in laid_out["tables"]]
            laid_out["figure"] = TableOf(**laid_out["figure"]) if laid_out["figure"] else None
            jobs = [Job(**job) for job in content.pop("jobs")]
            return cls(**content, jobs=jobs, results=Results(**laid_out))
        except OSError as error:
            remedy = "run the sweep to its end"
            raise InputError(f"cannot be read ({error.strerror})", str(path), remedy) from error
        except (ValueError, KeyError, TypeError, AttributeError) as error:
            raise InputError(f"is not a comparison ({error})", str(path), "run the sweep again") from error


def flat(metrics: Mapping[str, Any], prefix: str = "") -> Metrics:
    """Return nested metrics by names like `position/h50`, without entries that are neither a number nor null."""
    found: Metrics = {}
    for key, value in metrics.items():
        if isinstance(value, Mapping):
            found |= flat(value, f"{prefix}{key}/")
        elif value is None or (isinstance(value, int | float) and not isinstance(value, bool)):
            found[f"{prefix}{key}"] = value
    return found


def itself(metrics: Mapping[str, Any]) -> dict[str, Metrics]:
    """Return all metrics as the job's own."""
    return {"": flat(metrics)}
