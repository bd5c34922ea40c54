"""The pipeline of a branch as `dvc.yaml` states it, and how fresh each of its stages is."""

import json
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from simgap.errors import InputError

_PLACE = re.compile(r"artifacts/\$\{item\}/(\w+)")


@dataclass(frozen=True)
class Step:
    """One stage of the pipeline.

    Attributes:
        name: of the stage.
        reads: stages whose output it reads, in the order of the pipeline.
    """

    name: str
    reads: tuple[str, ...]


@dataclass(frozen=True)
class Freshness:
    """What the next reproduction would do with a stage.

    Attributes:
        state: `fresh`, `would run`, `may run` (when a stage before it writes something else) or `never ran`.
        reason: what has changed; empty where nothing has.
    """

    state: str
    reason: str = ""


def branches(root: Path) -> list[str]:
    """Return the branches that `dvc.yaml` names, in its order."""
    return next(entry["branches"] for entry in _read(root)["vars"] if "branches" in entry)


def steps(root: Path) -> list[Step]:
    """Return the stages that every branch has, in their order in `dvc.yaml`."""
    stages = {name: entry["do"] for name, entry in _read(root)["stages"].items()}
    return [
        Step(name, tuple(other for other in stages if other in _read_by(stages[name]))) for name in stages
    ]


def freshness(root: Path, branch: str) -> dict[str, Freshness]:
    """Return what the next reproduction of a branch would do, by stage.

    Raises:
        InputError: when DVC cannot say, since another DVC is at work, for example.
    """
    order = steps(root)
    changed, ran = _changes(root, [f"{step.name}@{branch}" for step in order]), _ran(root)
    found: dict[str, Freshness] = {}
    for step in order:
        target = f"{step.name}@{branch}"
        if target not in ran:
            found[step.name] = Freshness("never ran")
        elif target in changed:
            found[step.name] = Freshness("would run", changed[target])
        else:
            waiting = [other for other in step.reads if found[other].state != "fresh"]
            found[step.name] = Freshness("may run", f"after {waiting[0]}") if waiting else Freshness("fresh")
    return found


def _read(root: Path) -> dict[str, Any]:
    import yaml

    return yaml.safe_load((root / "dvc.yaml").read_text(encoding="utf-8"))


def _read_by(stage: dict[str, Any]) -> set[str]:
    return set(_PLACE.findall(json.dumps([stage.get("deps", []), stage.get("params", [])])))


def _ran(root: Path) -> set[str]:
    import yaml

    lock = root / "dvc.lock"
    return set((yaml.safe_load(lock.read_text(encoding="utf-8")) or {})["stages"]) if lock.exists() else set()


def _changes(root: Path, targets: list[str]) -> dict[str, str]:
    """Return the first change of every stage that DVC finds changed."""
    command = [str(Path(sys.executable).parent / "dvc"), "status", "--json", *targets]
    done = subprocess.run(command, cwd=root, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        reason = (done.stderr.strip().splitlines() or ["dvc status failed"])[0].removeprefix("ERROR: ")
        reason = reason.partition(", it is being blocked")[0]
        raise InputError(reason, str(root), "wait for the DVC that is at work here, or see dvc status")
    return {target: _first(entries) for target, entries in json.loads(done.stdout or "{}").items()}


def _first(entries: list[Any]) -> str:
    """Return one change in words: `stages/clean.py modified`."""
    changes = [entry for entry in entries if isinstance(entry, dict)]
    paths = {path: change for entry in changes for part in entry.values() for path, change in part.items()}
    text = [f"{path} {change if isinstance(change, str) else 'modified'}" for path, change in paths.items()]
    return text[0] + (f" and {len(text) - 1} more" if len(text) > 1 else "") if text else "changed"
