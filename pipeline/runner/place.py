"""Where a job stands in its sweep."""

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Place:
    """The place of a job in its sweep.

    Attributes:
        sweep: identifies the sweep to which all its jobs belong.
        folder: name of the folder of the sweep: its preset, or the stage.
        job: what the job is called among the others; also the name of its directory.
        values: what was swept, by key.
    """

    sweep: str
    folder: str
    job: str
    values: dict[str, Any]
