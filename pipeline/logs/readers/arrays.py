"""Archives of numpy arrays (.npz): arrays of one length are the columns of a table."""

import zipfile
import zlib
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from simgap.errors import InputError
from simgap.logs.log import Log
from simgap.logs.tabular import log_of_table

_LARGEST = 1 << 34  # bytes of one array; no log of a person has more
_WIDEST = 256  # columns of one array; more is a picture, not a joint
_FACTS = 8  # numbers of an array that is shown as a fact


def read(path: Path) -> Log:
    """Read arrays; those of n rows and k columns become name[0] … name[k-1].

    Nothing in the file is executed: arrays of Python objects are left out.

    Raises:
        InputError: when the archive is damaged or holds no arrays of one length.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            arrays, left_out = _arrays(archive)
    except (zipfile.BadZipFile, zlib.error, OSError, ValueError, EOFError, NotImplementedError, RuntimeError):
        raise InputError(
            "is a damaged archive of arrays", str(path), "write it again with numpy.savez"
        ) from None
    lengths = Counter(len(array) for array in arrays.values() if array.ndim and array.dtype.kind in "fiubMm")
    rows = max(lengths, key=lambda length: (lengths[length], length), default=0)
    if rows < 2:
        raise InputError("holds no arrays with samples", str(path), "save one array a quantity, n rows each")
    columns: dict[str, NDArray[np.generic]] = {}
    facts: dict[str, str] = {}
    for name, array in arrays.items():
        if array.ndim and len(array) == rows and array.size <= rows * _WIDEST:
            columns |= _columns(name, array)
        elif array.size <= _FACTS:
            facts[name] = ", ".join(str(value) for value in array.ravel().tolist())
        else:
            left_out.append(name)
    said = (
        (f"Left out, since they have other lengths or kinds: {', '.join(left_out[:6])}.",) if left_out else ()
    )
    return log_of_table(pd.DataFrame(columns, copy=False), path, "arrays", facts=facts, remarks=said)


def _arrays(archive: zipfile.ZipFile) -> tuple[dict[str, NDArray[np.generic]], list[str]]:
    """Return the arrays, and the names of what is none that can be read without running code."""
    arrays: dict[str, NDArray[np.generic]] = {}
    left_out = []
    for entry in archive.infolist():
        name = entry.filename.removesuffix(".npy")
        with archive.open(entry) as file:
            array = _array(file, entry.file_size) if entry.filename.endswith(".npy") else None
        if array is None:
            left_out.append(name)
        else:
            arrays[name] = array
    return arrays, left_out


def _array(file: Any, size: int) -> NDArray[np.generic] | None:
    """Return an array whose header promises no more than there is; None for one of objects."""
    version = np.lib.format.read_magic(file)
    header = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
    shape, by_column, kind = header(file)
    if kind.hasobject or kind.names or kind.kind not in "fiubMmU":
        return None
    count = int(np.prod(shape, dtype=object)) if shape else 1
    if count * kind.itemsize > min(size, _LARGEST):
        raise ValueError("the header promises more than there is")
    content = file.read(count * kind.itemsize)
    return np.frombuffer(content, dtype=kind, count=count).reshape(shape, order="F" if by_column else "C")


def _columns(name: str, array: NDArray[np.generic]) -> dict[str, NDArray[np.generic]]:
    if array.ndim == 1:
        return {name: array}
    flat = array.reshape(len(array), -1)
    if array.ndim == 2:
        return {f"{name}[{place}]": flat[:, place] for place in range(flat.shape[1])}
    places = np.ndindex(*array.shape[1:])
    return {
        f"{name}{''.join(f'[{index}]' for index in place)}": flat[:, number]
        for number, place in enumerate(places)
    }
