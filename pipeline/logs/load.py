"""Loading of the recording that a dataset configuration names."""

import dataclasses
import glob
from pathlib import Path

from simgap.errors import InputError
from simgap.logs.opening import open_recording
from simgap.recordings.dataset import Dataset
from simgap.recordings.importers import importer
from simgap.recordings.recording import Recording
from simgap.recordings.registry import fetch, published


def load_dataset(dataset: Dataset, mapping: str | None = None) -> Recording:
    """Load a published dataset or a user's own.

    Args:
        dataset: its configuration; `source` is published or file.
        mapping: path of a mapping of a log of one's own; None where the log needs none.

    Raises:
        InputError: when it cannot be had or cannot be used.
    """
    if dataset.source == "published":
        entry = published(dataset.name)
        if dataset.importer is None:
            raise InputError(
                "no importer is named", "dataset.importer", f"name the format of {dataset.name!r}"
            )
        recording = importer(dataset.importer)(fetch(dataset.name, dataset.files), dataset.options)
        return dataclasses.replace(recording, source=entry.source, licence=entry.licence)
    if dataset.source != "file":
        raise InputError(
            f"unknown source {dataset.source!r}", "dataset.source", "use published, file or reality"
        )
    paths = _own_files(dataset)
    if dataset.importer is not None:
        recording = importer(dataset.importer)(paths, dataset.options)
        return dataclasses.replace(recording, source=recording.source or dataset.name)
    if len(paths) > 1:
        raise InputError(
            f"{len(paths)} files without an importer",
            "dataset.files",
            "give one recording, or dataset.importer=table",
        )
    return open_recording(paths[0], mapping=Path(mapping) if mapping else None)


def _own_files(dataset: Dataset) -> list[Path]:
    if not dataset.files:
        raise InputError(
            "no recording is given", "dataset.files", "choose dataset=NAME, or give recording=PATH"
        )
    paths: list[Path] = []
    for pattern in dataset.files:
        found = sorted(glob.glob(str(Path(pattern).expanduser())))
        if not found:
            raise InputError(f"{pattern!r} matches no file", "dataset.files", "check the path")
        paths += [Path(path) for path in found]
    return paths
