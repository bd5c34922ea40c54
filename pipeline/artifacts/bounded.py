"""Reading of a part of a person's file, or one line that says why that is not possible."""

from pathlib import Path

from simgap.errors import InputError


def first_bytes(path: Path, count: int) -> bytes:
    """Return the first bytes of a recording, fewer where it is shorter.

    Raises:
        InputError: when it is missing, a folder, empty, or cannot be read.
    """
    if path.is_dir():
        raise InputError("is a folder", str(path), "give the path of one file")
    try:
        with path.open("rb") as file:
            head = file.read(count)
    except FileNotFoundError:
        raise InputError("does not exist", str(path), "check the path of the recording") from None
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror})", str(path), "check its permissions") from None
    if not head:
        raise InputError("is empty", str(path), "record it again, or give another file")
    return head


def whole_of(path: Path, megabytes: int, remedy: str) -> bytes:
    """Return all bytes of a small file.

    Args:
        path: of the file.
        megabytes: that it may have at most; no more is read.
        remedy: what to do with a larger one.

    Raises:
        InputError: when it cannot be read, or is larger.
    """
    largest = megabytes << 20
    try:
        with path.open("rb") as file:
            content = file.read(largest + 1)
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror})", str(path), "check the path") from error
    if len(content) > largest:
        raise InputError(f"is larger than {megabytes} MB", str(path), remedy)
    return content
