"""Finished jobs of a sweep. Each job stores the origin of its output, so that an interrupted sweep continues."""

import json
import sys
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from simgap.artifacts import PACKAGE, hash_path
from simgap.comparison.machine import machine
from simgap.errors import InputError

FILE = "job.json"

_ROOT = PACKAGE.parent


@dataclass(frozen=True)
class Note:
    """The origin of an output.

    Attributes:
        identity: hash of the configuration.
        values: what was swept.
        seed: of every random draw.
        seconds: that the job took.
        inputs: SHA-256 of every input, by path.
        machine: that ran the job.
        code: SHA-256 of every file of the project that was loaded, by its path beside the package.
    """

    identity: str
    values: dict[str, Any]
    seed: int
    seconds: float
    inputs: dict[str, str]
    machine: str = field(default_factory=lambda: machine())
    code: dict[str, str] = field(default_factory=lambda: loaded_code())

    def write(self, folder: Path) -> None:
        """Write the note beside the output."""
        (folder / FILE).write_text(json.dumps(asdict(self), indent=1) + "\n", encoding="utf-8")

    @classmethod
    def read(cls, folder: Path) -> "Note | None":
        """Return the note of a finished job; None where there is none."""
        try:
            return cls(**json.loads((folder / FILE).read_text(encoding="utf-8")))
        except (OSError, ValueError, TypeError):
            return None

    def holds(self, identity: str) -> bool:
        """Whether configuration, inputs and code are unchanged, so that the job need not run again."""
        files = self.inputs | {str(_ROOT / path): digest for path, digest in self.code.items()}
        return self.identity == identity and _unchanged(files)


def loaded_code() -> dict[str, str]:
    """Return the SHA-256 of every file of the package that this process has loaded."""
    modules = [module for name, module in list(sys.modules.items()) if name.partition(".")[0] == "simgap"]
    files = {Path(place) for module in modules if (place := getattr(module, "__file__", None))}
    return {path.relative_to(_ROOT).as_posix(): hash_path(path) for path in sorted(files)}


def _unchanged(files: Mapping[str, str]) -> bool:
    try:
        return all(hash_path(path) == digest for path, digest in files.items())
    except InputError:
        return False
