"""Damaged files: cut off, with flipped bits, with a stretch replaced; what comes out is a log or one line."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from hypothesis import strategies as st

from simgap.errors import InputError
from simgap.logs.log import Log


@st.composite
def damaged(draw: st.DrawFn, content: bytes) -> bytes:
    """Return the content with some damage."""
    changed = bytearray(content)
    for _ in range(draw(st.integers(0, 8))):
        place = draw(st.integers(0, len(changed) - 1))
        changed[place] ^= 1 << draw(st.integers(0, 7))
    place = draw(st.integers(0, len(changed) - 1))
    changed[place : place + draw(st.integers(0, 20))] = draw(st.binary(max_size=20))
    return bytes(changed[: draw(st.integers(0, len(changed)))])


def assert_a_log_or_one_line(read: Callable[[Path], Log], path: Path, content: bytes) -> None:
    """Every signal of a log can be looked at, and has as many times as values; no other error comes than ours."""
    path.write_bytes(content)
    log = _read(read, path)
    if log is None:
        return
    total = 0
    for signal in log.signals.values():
        assert signal.time.shape == signal.values.shape
        assert signal.values.dtype == np.float64
        total += len(signal.values)
    assert total <= len(content)  # a value takes a byte or more


def _read(read: Callable[[Path], Log], path: Path) -> Log | None:
    try:
        return read(path)
    except InputError:
        return None
