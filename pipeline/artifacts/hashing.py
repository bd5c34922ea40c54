"""The identity of an artifact: SHA-256 of its content, independent of time stamps and location."""

import hashlib
import json
from pathlib import Path
from typing import Any

from simgap.errors import InputError


def hash_path(path: str | Path) -> str:
    """Return the SHA-256 of a file, or of a directory: the names and contents of all its files.

    Raises:
        InputError: when the path is not there or cannot be read.
    """
    path = Path(path)
    try:
        return _hash_tree(path) if path.is_dir() else _hash_file(path)
    except OSError as error:
        reason = f"cannot be read ({error.strerror})"
        raise InputError(reason, str(error.filename or path), "check the path and its rights") from error


def hash_value(value: Any) -> str:
    """Return the SHA-256 of a plain value (mappings, lists, numbers, text), in any order of keys."""
    return hashlib.sha256(json.dumps(value, sort_keys=True, default=str).encode()).hexdigest()


def _hash_file(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _hash_tree(root: Path) -> str:
    digest = hashlib.sha256()
    files = {path.relative_to(root).as_posix(): path for path in root.rglob("*") if path.is_file()}
    for name in sorted(files):
        digest.update(f"{name}\0{_hash_file(files[name])}\n".encode())
    return digest.hexdigest()
