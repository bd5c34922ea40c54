"""The bytes of a file, or one line that says why there are none."""

from pathlib import Path

from simgap.errors import InputError


def bytes_of(path: Path) -> bytes:
    """Return all bytes of a file.

    Raises:
        InputError: when it cannot be read.
    """
    try:
        return path.read_bytes()
    except FileNotFoundError:
        raise InputError("does not exist", str(path), "check the path of the recording") from None
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror})", str(path), "check its permissions") from None
