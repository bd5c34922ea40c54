"""The configuration of a dataset: source, importer and division of its runs."""

from dataclasses import dataclass, field
from typing import Any

from simgap.recordings.split import Split


@dataclass
class Dataset:
    """One entry of the configuration group `dataset`."""

    name: str = "own"  # its name; for published recordings the name in the registry
    source: str = (
        "file"  # file: a person's own; published: the registry; reality: the project's own concealed plant
    )
    importer: str | None = None  # the format of the files; null for recordings as the contract defines them
    files: list[str] = field(default_factory=list)  # paths, or patterns of the registry's files
    options: dict[str, Any] = field(default_factory=dict)  # what the importer needs to know
    split: Split = field(default_factory=Split)
