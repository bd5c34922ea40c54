"""Atomic writing of directories.

A stage writes to a hidden sibling of the target, `.partial-NAME-…`, which is renamed into place at the end. The
writer locks that sibling. The system releases the lock when the process ends in any way, so that the next writer
recognises and removes an abandoned one.
"""

import errno
import fcntl
import os
import shutil
import uuid
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from simgap.errors import InputError

_PREFIX = ".partial-"
_REPLACED = ".replaced"
_FULL = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG}
_REFUSED = {errno.EACCES, errno.EPERM, errno.EROFS}
_REMEDY = "choose another place with output=DIR"
_LIST = ".simgap"  # the names of what was written here before, one a line
_USUAL = (
    "clean",
    "diagnosis.json",
    "evidence",
    "metrics.json",
    "recording.parquet",
    "report.html",
    "simulator",
)
"""Names that most stages write: they are refused before the work, any other one after it."""


@contextmanager
def staged_directory(target: str | Path, owned: bool = False) -> Iterator[Path]:
    """Yield an empty directory that takes the place of `target` when the block ends without an exception.

    Args:
        target: the directory to write; its parents are made.
        owned: the directory holds nothing but earlier output, so it is replaced as a whole. Otherwise,
            entries that were not written now stay, and only entries of the same name are replaced.

    Raises:
        InputError: when the place cannot be written, holds a user's own entry of a name that is to be written, or the
            disk is full. Nothing is left behind then.
    """
    place = Path(os.path.realpath(target))
    with _said(place):
        if not owned:
            _refuse_foreign(place, _USUAL)
        parent = place if _only_inside(place) else place.parent
        made = [path for path in (parent, *parent.parents) if not path.exists()]
    try:
        with _said(place):
            staging, lock = _staging(parent, place)
        try:
            with _said(place, staging):
                yield staging
            with _said(place), _guarded(parent):
                _commit(staging, place, owned)
        finally:
            shutil.rmtree(staging, ignore_errors=True)
            os.close(lock)
    except BaseException:
        for path in made:
            with suppress(OSError):
                path.rmdir()
        raise


def _only_inside(place: Path) -> bool:
    """Whether no sibling can be made: of a mounted volume, or in a directory that is read-only."""
    return place.is_dir() and (os.path.ismount(place) or not os.access(place.parent, os.W_OK))


def _staging(parent: Path, place: Path) -> tuple[Path, int]:
    """Make the hidden sibling; return it and the descriptor that holds its lock."""
    if place.exists() and not place.is_dir():
        raise InputError("is a file where a directory is to be written", str(place), _REMEDY)
    parent.mkdir(parents=True, exist_ok=True)
    with _guarded(parent):
        _remove_abandoned(parent, place)
        staging = parent / f"{_PREFIX}{place.name}-{uuid.uuid4().hex[:8]}"
        staging.mkdir()
        return staging, _locked(staging)


@contextmanager
def _guarded(parent: Path) -> Iterator[None]:
    """Keep writers in one directory apart while they make their hidden sibling or put it in place."""
    guard = _locked(parent)
    try:
        yield
    finally:
        os.close(guard)


def _locked(directory: Path) -> int:
    descriptor = os.open(directory, os.O_RDONLY)
    fcntl.flock(descriptor, fcntl.LOCK_EX)
    return descriptor


def _remove_abandoned(parent: Path, place: Path) -> None:
    for entry in sorted(parent.iterdir()):
        if not entry.name.startswith(f"{_PREFIX}{place.name}-") or _is_alive(entry):
            continue
        if entry.name.endswith(_REPLACED) and not place.exists():
            entry.rename(place)  # killed between the two renames of a swap: the old state is the whole one
        else:
            shutil.rmtree(entry, ignore_errors=True)


def _is_alive(staging: Path) -> bool:
    try:
        descriptor = os.open(staging, os.O_RDONLY)
    except FileNotFoundError:  # its writer has just removed it
        return True
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return True
    finally:
        os.close(descriptor)
    return False


def _commit(staging: Path, place: Path, owned: bool) -> None:
    written = {entry.name for entry in staging.iterdir()}
    if not owned:
        _refuse_foreign(place, written)
        (staging / _LIST).write_text("".join(f"{name}\n" for name in sorted(written)), encoding="utf-8")
        written.add(_LIST)
    foreign = place.exists() and any(entry.name not in written for entry in place.iterdir())
    if staging.parent == place or (foreign and not owned):
        for name in sorted(written):
            _swap(staging / name, place / name)
    else:
        _swap(staging, place)


def _refuse_foreign(place: Path, names: Iterable[str]) -> None:
    """Refuse to replace what an earlier output did not leave there: it is a user's own."""
    before = (place / _LIST).read_text(encoding="utf-8").split("\n") if (place / _LIST).is_file() else []
    own = sorted(name for name in names if name not in before and os.path.lexists(place / name))
    if own:
        raise InputError(f"holds {', '.join(own)}, which simgap did not write", str(place), _REMEDY)


def _swap(new: Path, place: Path) -> None:
    """Put `new` in the place of `place`; a directory is away for no longer than one rename."""
    if new.is_file() and not place.is_dir():
        new.replace(place)
        return
    old = new.with_name(new.name + _REPLACED)
    with suppress(FileNotFoundError):
        place.rename(old)
    new.rename(place)
    shutil.rmtree(old, ignore_errors=True) if old.is_dir() else old.unlink(missing_ok=True)


@contextmanager
def _said(place: Path, staging: Path | None = None) -> Iterator[None]:
    """Say in one line why `place` cannot be written; with `staging`, leave errors of other files alone."""
    try:
        yield
    except InputError as error:
        if staging is None or str(staging) not in str(error):
            raise
        raise InputError(str(error).replace(str(staging), str(place))) from error
    except Exception as error:
        number = error.errno if isinstance(error, OSError) else None
        # Some libraries (safetensors) keep only the text of the system's error.
        if number in _FULL or os.strerror(errno.ENOSPC) in str(error):
            raise InputError("the disk is full", str(place), f"free some space, or {_REMEDY}") from error
        if not isinstance(error, OSError):
            raise
        own = staging is None or (number in _REFUSED and str(error.filename).startswith(str(staging)))
        if not own:
            raise
        raise InputError(f"cannot be written ({error.strerror})", str(place), _REMEDY) from error
