"""Texts in JSON that are the same but for their numbers: a compiled loop finds these, Arrow converts them.

A parser builds something of every key and bracket of every text. Where those repeat, it is enough to compare them.
"""

import re
from collections.abc import Sequence

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from simgap import compiled

_AT_ONCE = 1 << 14  # texts whose numbers are gathered and then converted: they still are near the processor
_LONGEST = (1 << 31) - 1  # bytes of the texts of these: Arrow counts in 32 bits
_TOKEN = re.compile(
    rb'"(?:\\.|[^"\\])*"|(-?(?:0|[1-9]\d*)(?:\.\d+)?(?:[eE][+-]?\d+)?)'
)  # a text, or a number
_DIGITS = b"0123456789"
_NOWHERE, _BEGIN, _MINUS, _ZERO, _LESS_ZERO, _WHOLE, _POINT, _FRACTION, _POWER, _SIGN, _EXPONENT = range(11)
_STATES = 11
_AFTER: tuple[tuple[tuple[int, ...], bytes, int], ...] = (
    ((_BEGIN,), b"-", _MINUS),
    ((_BEGIN,), b"0", _ZERO),
    ((_MINUS,), b"0", _LESS_ZERO),
    ((_BEGIN, _MINUS), b"123456789", _WHOLE),
    ((_WHOLE,), _DIGITS, _WHOLE),
    ((_ZERO, _LESS_ZERO, _WHOLE), b".", _POINT),
    ((_POINT, _FRACTION), _DIGITS, _FRACTION),
    ((_ZERO, _LESS_ZERO, _WHOLE, _FRACTION), b"eE", _POWER),
    ((_POWER,), b"+-", _SIGN),
    ((_POWER, _SIGN, _EXPONENT), _DIGITS, _EXPONENT),
)
"""JSON's grammar of numbers: where one is after which letters."""

_COMPLETE = (
    _ZERO,
    _WHOLE,
    _FRACTION,
    _EXPONENT,
)  # not -0, which is a whole number without a sign, and -0.0 has one


def _steps() -> NDArray[np.uint8]:
    """Return the state after each state and byte, (states · 256,); where none follows, it is nowhere."""
    steps = np.full((_STATES, 256), _NOWHERE, dtype=np.uint8)
    for states, letters, after in _AFTER:
        steps[np.ix_(states, tuple(letters))] = after
    return steps.reshape(-1)


_STEPS = _steps()
_ENDS = np.isin(np.arange(_STATES), _COMPLETE).astype(np.uint8)


def between_numbers(text: bytes) -> list[bytes]:
    """Return what stands before the first number of a text in JSON, between each two, and behind the last."""
    parts, end = [], 0
    for token in _TOKEN.finditer(text):
        if token.group(1) is not None:
            parts.append(text[end : token.start()])
            end = token.end()
    return [*parts, text[end:]]


def numbers_alike(
    buffer: NDArray[np.uint8], begins: NDArray[np.int64], sizes: NDArray[np.int64], between: Sequence[bytes]
) -> NDArray[np.float64] | None:
    """Return the numbers of texts, (texts, numbers), each column in one piece of memory; None where a text is another.

    Args:
        buffer: bytes, (bytes,).
        begins: place of each text, (texts,).
        sizes: of each, in bytes, (texts,).
        between: what stands between the numbers, see `between_numbers`.
    """
    loop = compiled.for_size(_digits, compiled.LARGE)
    fixed, ends = np.frombuffer(b"".join(between), dtype=np.uint8), np.cumsum([len(part) for part in between])
    numbers = np.empty((len(between) - 1, len(begins)))
    for first in range(0, len(begins), _AT_ONCE):
        part = slice(first, first + _AT_ONCE)
        room = int(sizes[part].sum())
        if room > _LONGEST:
            return None
        digits, past = np.empty(room, dtype=np.uint8), np.zeros(numbers[:, part].size + 1, dtype=np.int32)
        arguments = buffer, begins[part], sizes[part], fixed, ends, _STEPS, _ENDS, digits, past
        if not loop(*(each.data for each in arguments)):
            return None
        written = pa.StringArray.from_buffers(len(past) - 1, pa.py_buffer(past), pa.py_buffer(digits))
        numbers[:, part] = written.cast(pa.float64()).to_numpy().reshape(numbers[:, part].T.shape).T
    return numbers.T


def _digits(
    text: memoryview,
    begins: memoryview,
    sizes: memoryview,
    fixed: memoryview,
    ends: memoryview,
    steps: memoryview,
    complete: memoryview,
    digits: memoryview,
    offsets: memoryview,
) -> bool:
    """Put down the letters of all numbers, and where each ends; return whether all texts are alike.

    It can be compiled: `simgap.compiled`.
    """
    found = put = 0
    for row in range(len(begins)):
        at, past, place = begins[row], begins[row] + sizes[row], 0
        for part in range(len(ends)):
            if part > 0:
                state = 1
                while at < past:
                    after = steps[256 * state + text[at]]
                    if after == 0:
                        break
                    state = after
                    digits[put] = text[at]
                    put += 1
                    at += 1
                if complete[state] == 0:
                    return False
                found += 1
                offsets[found] = put
            while place < ends[part]:
                if at >= past or text[at] != fixed[place]:
                    return False
                place += 1
                at += 1
        if at != past:
            return False
    return True
