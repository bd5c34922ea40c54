"""Compiled readers of the numbers in a blackbox log, encoding by encoding.

A change here needs one in `blackbox_frames` too: what is compiled is kept by the file that calls it.
Source: "Blackbox logging internals", betaflight.com/docs/development/blackbox-internals.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

Integers = NDArray[np.int64]

_WORD = 0xFFFFFFFF


@njit(cache=True)
def byte_at(data: NDArray[np.uint8], at: int) -> int:
    """Return a byte as a number of 64 bits, in which it can be shifted."""
    return np.int64(data[at])  # type: ignore[return-value]


@njit(cache=True)
def signed(value: int, bits: int) -> int:
    """Return the two's complement number in the lowest bits."""
    half = 1 << (bits - 1)
    return ((value & ((1 << bits) - 1)) ^ half) - half


@njit(cache=True)
def unsigned_bytes(data: NDArray[np.uint8], at: int, end: int) -> tuple[int, int]:
    """Return a number of seven bits a byte, and the place behind it; −1 where there is none."""
    value = 0
    for place in range(5):
        if at + place >= end:
            break
        byte = byte_at(data, at + place)
        value |= (byte & 0x7F) << (7 * place)
        if byte < 0x80:
            return value & _WORD, at + place + 1
    return 0, -1


@njit(cache=True)
def signed_bytes(data: NDArray[np.uint8], at: int, end: int) -> tuple[int, int]:
    """Return a number with its sign in the lowest bit (ZigZag), and the place behind it; −1 where there is none."""
    value, at = unsigned_bytes(data, at, end)
    return (value >> 1) ^ -(value & 1), at


@njit(cache=True)
def _bits(data: NDArray[np.uint8], bit: int, count: int) -> int:
    """Return a signed number that begins at a bit of the data, the most significant bit first."""
    value = 0
    for place in range(bit, bit + count):
        value = (value << 1) | ((byte_at(data, place >> 3) >> (7 - (place & 7))) & 1)
    return signed(value, count)


@njit(cache=True)
def _three(data: NDArray[np.uint8], at: int, end: int, uneven: bool, out: Integers) -> int:
    """Read three values behind a tag of two bits (TAG2_3S32 and TAG2_3SVARIABLE); return the place behind them.

    Args:
        data: bytes.
        at: of the tag.
        end: of the data.
        uneven: whether the short forms have 5, 5, 4 and 8, 7, 7 bits instead of 4 and 6 each.
        out: for the values, (3,).
    """
    if at >= end:
        return -1
    tag = byte_at(data, at) >> 6
    if tag == 3:
        lengths = byte_at(data, at)
        at += 1
        for place in range(3):
            count = ((lengths >> (2 * place)) & 3) + 1
            if at + count > end:
                return -1
            value = 0
            for byte in range(count):
                value |= byte_at(data, at + byte) << (8 * byte)
            out[place] = signed(value, 8 * count)
            at += count
        return at
    if at + tag + 1 > end:
        return -1
    bit = 8 * at + 2
    for place in range(3):
        count = 2
        if uneven and tag == 1:
            count = 5 if place < 2 else 4
        elif uneven and tag == 2:
            count = 8 if place == 0 else 7
        elif tag > 0:
            count = 2 * (tag + 1)
            bit = 8 * (at + place) + 2 if tag == 2 else 8 * at + 4 + 4 * place
        out[place] = _bits(data, bit, count)
        bit += count
    return at + tag + 1


@njit(cache=True)
def _four(data: NDArray[np.uint8], at: int, end: int, out: Integers) -> int:
    """Read four values of 0, 4, 8 or 16 bits (TAG8_4S16); return the place behind them, −1 where there is none."""
    if at >= end:
        return -1
    tags = byte_at(data, at)
    bit = 8 * (at + 1)
    for place in range(4):
        tag = (tags >> (2 * place)) & 3
        count = 0 if tag == 0 else 2 << tag
        if bit + count > 8 * end:
            return -1
        out[place] = _bits(data, bit, count) if count else 0
        bit += count
    return (bit + 7) >> 3


@njit(cache=True)
def _eight(data: NDArray[np.uint8], at: int, end: int, out: Integers) -> int:
    """Read up to eight values, a bit for each that is not zero before them (TAG8_8SVB); one alone has no such bit."""
    tags = 1
    if len(out) > 1:
        if at >= end:
            return -1
        tags = byte_at(data, at)
        at += 1
    if tags >> len(out):
        return -1
    for place in range(len(out)):
        out[place] = 0
        if (tags >> place) & 1 and at >= 0:
            out[place], at = signed_bytes(data, at, end)
    return at


@njit(cache=True)
def residuals(
    data: NDArray[np.uint8], at: int, end: int, encodings: Integers, out: Integers, group: Integers
) -> int:
    """Read what the predictors leave of each field; return the place behind the frame, −1 where it is none.

    Args:
        data: bytes.
        at: of the frame's first field.
        end: of the data.
        encodings: by field.
        out: for the values, by field.
        group: room for the four values that share a tag, here so that it is made once.
    """
    field, fields = 0, len(encodings)
    while field < fields and at >= 0:
        encoding = encodings[field]
        taken = 1
        if encoding == 0:
            out[field], at = signed_bytes(data, at, end)
        elif encoding == 1:
            out[field], at = unsigned_bytes(data, at, end)
        elif encoding == 3:
            value, at = unsigned_bytes(data, at, end)
            out[field] = -signed(value, 14)
        elif encoding == 9:
            out[field] = 0
        elif encoding == 6:
            while taken < 8 and field + taken < fields and encodings[field + taken] == 6:
                taken += 1
            at = _eight(data, at, end, out[field : field + taken])
        else:
            most = 4 if encoding == 8 else 3
            at = (
                _four(data, at, end, group) if encoding == 8 else _three(data, at, end, encoding == 10, group)
            )
            while taken < most and field + taken < fields and encodings[field + taken] == encoding:
                taken += 1
            for place in range(taken):
                out[field + place] = group[place]
        field += taken
    return at
