"""Published recordings: address, licence and SHA-256 of each file."""

import difflib
import os
import threading
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path, PurePosixPath
from urllib.parse import quote

import yaml

from simgap.errors import InputError

CACHE_VARIABLE = "SIMGAP_CACHE"
FOLDER_VARIABLE = "SIMGAP_DATA"

_PUBLISHED_TABLES = Path(__file__).parent / "published"
_ADDRESS = "https://raw.githubusercontent.com/{repository}/{commit}/{path}"
_CONNECT, _READ = 3.0, 20.0  # s; a machine without a network should say so soon
_PROBE = 5.0  # s, the whole of it, name resolution included


@dataclass(frozen=True)
class PublishedFile:
    """One file of a dataset.

    Attributes:
        name: path within the dataset, as in the cache and in the folder of `SIMGAP_DATA`.
        address: where it is served.
        sha256: its hash.
    """

    name: str
    address: str
    sha256: str


@dataclass(frozen=True)
class Published:
    """A published dataset at a fixed commit."""

    name: str
    title: str
    repository: str
    commit: str
    licence: str
    citation: str
    files: tuple[PublishedFile, ...]

    @property
    def source(self) -> str:
        """Say where the dataset comes from, to be cited."""
        return f"{self.citation}; {self.repository} at {self.commit[:8]}"

    def select(self, patterns: Sequence[str] = ()) -> list[PublishedFile]:
        """Return the files that match any pattern (all files without one), in the order of their names.

        Raises:
            InputError: when a pattern matches no file.
        """
        for pattern in patterns:
            if not any(fnmatchcase(file.name, pattern) for file in self.files):
                raise InputError(
                    f"{pattern!r} matches no file of {self.name!r}", "dataset.files", "correct it"
                )
        chosen = [f for f in self.files if not patterns or any(fnmatchcase(f.name, p) for p in patterns)]
        return sorted(chosen, key=lambda file: file.name)


def published_names() -> list[str]:
    """Return the names of the published datasets."""
    return sorted(path.stem for path in _PUBLISHED_TABLES.glob("*.yaml"))


def published(name: str) -> Published:
    """Return the entry of a published dataset.

    Raises:
        InputError: when there is none of that name.
    """
    path = _PUBLISHED_TABLES / f"{name}.yaml"
    if name not in published_names():
        near = difflib.get_close_matches(name, published_names(), n=1)
        remedy = f"did you mean {near[0]!r}?" if near else f"use one of {', '.join(published_names())}"
        raise InputError(f"no published dataset {name!r}", "dataset.name", remedy)
    table = yaml.safe_load(path.read_text(encoding="utf-8"))
    files = tuple(_files(table))
    return Published(
        name=name,
        title=table["title"],
        repository=table["repository"],
        commit=table["commit"],
        licence=table["licence"],
        citation=table["citation"],
        files=files,
    )


def _files(table: dict) -> Iterator[PublishedFile]:
    for folder in table["folders"]:
        for name, sha256 in folder["sha256"].items():
            path = quote(str(PurePosixPath(folder["there"]) / name))
            address = _ADDRESS.format(repository=table["repository"], commit=table["commit"], path=path)
            yield PublishedFile(str(PurePosixPath(folder["here"]) / name), address, sha256)


def cache_folder() -> Path:
    """Return the folder of downloaded recordings (`SIMGAP_CACHE`, else the system's cache)."""
    import pooch

    return Path(os.environ.get(CACHE_VARIABLE) or pooch.os_cache("simgap"))


def fetch(dataset: str, patterns: Sequence[str] = ()) -> list[Path]:
    """Return the files of a dataset: from the cache, else the folder named by `SIMGAP_DATA`, else downloaded.

    Args:
        dataset: name in the registry.
        patterns: which of its files, as file names are matched; all without one.

    Raises:
        InputError: when a file is nowhere to be had, or is not the published one.
    """
    entry = published(dataset)
    return [_fetch(entry, file) for file in entry.select(patterns)]


def _fetch(entry: Published, file: PublishedFile) -> Path:
    for _, path in _places(entry, file):
        if path.is_file():
            _verify(path, file)
            return path
    return _download(entry, file)


def _places(entry: Published, file: PublishedFile) -> Iterator[tuple[str, Path]]:
    yield "cache", cache_folder() / entry.name / entry.commit[:8] / file.name
    if folder := os.environ.get(FOLDER_VARIABLE):
        yield FOLDER_VARIABLE, Path(folder) / entry.name / file.name


def _verify(path: Path, file: PublishedFile) -> None:
    import pooch

    try:
        found = pooch.file_hash(str(path), alg="sha256")
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror})", str(path), "check its permissions") from None
    if found != file.sha256:
        what = f"is not the published file (SHA-256 {found[:12]}… instead of {file.sha256[:12]}…)"
        raise InputError(what, str(path), f"delete it; it is fetched again from {file.address}")


def _download(entry: Published, file: PublishedFile) -> Path:
    import sys

    import pooch
    import requests

    pooch.get_logger().setLevel("WARNING")
    target = next(path for _, path in _places(entry, file))
    downloader = pooch.HTTPDownloader(progressbar=sys.stderr.isatty(), timeout=(_CONNECT, _READ))
    try:
        return Path(
            pooch.retrieve(
                file.address, f"sha256:{file.sha256}", target.name, target.parent, downloader=downloader
            )
        )
    except requests.RequestException as error:
        remedy = f"connect to the network, or name the folder of the recordings in {FOLDER_VARIABLE}"
        raise InputError(f"cannot be downloaded ({type(error).__name__})", file.address, remedy) from None
    except ValueError:
        raise InputError(
            "what was downloaded is not the published file", file.address, "try again later"
        ) from None
    except OSError as error:
        raise InputError(
            f"cannot be written ({error.strerror})", str(target), f"set {CACHE_VARIABLE}"
        ) from None


def locate(dataset: str, patterns: Sequence[str] = ()) -> str | None:
    """Say from where a dataset would come, without fetching it: cache, SIMGAP_DATA, download or None.

    A connection is tried only where a file is neither cached nor in the folder, for a few seconds at most.

    Raises:
        InputError: when there is no such dataset.
    """
    entry = published(dataset)
    origins: set[str] = set()
    for file in entry.select(patterns):
        origin = next((name for name, path in _places(entry, file) if path.is_file()), None)
        if origin is None:
            return "download" if _reachable(file.address) else None
        origins.add(origin)
    return FOLDER_VARIABLE if FOLDER_VARIABLE in origins else "cache"


def _reachable(address: str) -> bool:
    """Whether an address answers in time; in a thread, as name resolution has no time limit of its own."""
    answers: list[bool] = []

    def probe() -> None:
        import requests

        try:
            answers.append(requests.head(address, timeout=_CONNECT, allow_redirects=True).ok)
        except requests.RequestException:
            answers.append(False)

    thread = threading.Thread(target=probe, daemon=True)
    thread.start()
    thread.join(_PROBE)
    return bool(answers and answers[0])
