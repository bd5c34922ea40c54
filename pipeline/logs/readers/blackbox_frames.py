"""Compiled decoder of the frames of a blackbox log.

Source: "Blackbox logging internals", betaflight.com/docs/development/blackbox-internals.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

Integers = NDArray[np.int64]

INTRA, INTER, SLOW, GPS, HOME, EVENT, OTHER = range(7)
"""Kinds of frames, in the order of their letters I, P, S, G, H and E; and what is none."""

_TIME, _IN_STEP, _KEYED, _IGNORED, _DAMAGED, _CLOSED, _ROWS = range(7)
"""Places in the state of decoding, before the numbers of main, slow and GPS frames."""

_WORD = 0xFFFFFFFF
_LONGEST_LEAP = 10_000_000  # µs between two frames; a damaged frame leaps anywhere
_KEYS_IGNORED = 2  # key frames whose time goes back, after which the clock is believed to have been reset
_END_OF_LOG = np.frombuffer(b"\xffEnd of log", dtype=np.uint8)
_LETTERS = np.frombuffer(b"IPSGHE", dtype=np.uint8)

MIN_THROTTLE, BATTERY, MIN_MOTOR, NUMERATOR, DENOMINATOR, KEY_INTERVAL, TIME, MOTOR = range(8)
"""Places in the settings that `decode` takes."""


@njit(cache=True)
def _byte(data: NDArray[np.uint8], at: int) -> int:
    """Return a byte as a number of 64 bits, in which it can be shifted."""
    return np.int64(data[at])  # type: ignore[return-value]


@njit(cache=True)
def _signed(value: int, bits: int) -> int:
    """Return the two's complement number in the lowest bits."""
    half = 1 << (bits - 1)
    return ((value & ((1 << bits) - 1)) ^ half) - half


@njit(cache=True)
def _unsigned_bytes(data: NDArray[np.uint8], at: int, end: int) -> tuple[int, int]:
    """Return a number of seven bits a byte, and the place behind it; −1 where there is none."""
    value = 0
    for place in range(5):
        if at + place >= end:
            break
        byte = _byte(data, at + place)
        value |= (byte & 0x7F) << (7 * place)
        if byte < 0x80:
            return value & _WORD, at + place + 1
    return 0, -1


@njit(cache=True)
def _signed_bytes(data: NDArray[np.uint8], at: int, end: int) -> tuple[int, int]:
    """Return a number with its sign in the lowest bit (ZigZag), and the place behind it; −1 where there is none."""
    value, at = _unsigned_bytes(data, at, end)
    return (value >> 1) ^ -(value & 1), at


@njit(cache=True)
def _bits(data: NDArray[np.uint8], bit: int, count: int) -> int:
    """Return a signed number that begins at a bit of the data, the most significant bit first."""
    value = 0
    for place in range(bit, bit + count):
        value = (value << 1) | ((_byte(data, place >> 3) >> (7 - (place & 7))) & 1)
    return _signed(value, count)


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
    tag = _byte(data, at) >> 6
    if tag == 3:
        lengths = _byte(data, at)
        at += 1
        for place in range(3):
            count = ((lengths >> (2 * place)) & 3) + 1
            if at + count > end:
                return -1
            value = 0
            for byte in range(count):
                value |= _byte(data, at + byte) << (8 * byte)
            out[place] = _signed(value, 8 * count)
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
    tags = _byte(data, at)
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
        tags = _byte(data, at)
        at += 1
    if tags >> len(out):
        return -1
    for place in range(len(out)):
        out[place] = 0
        if (tags >> place) & 1 and at >= 0:
            out[place], at = _signed_bytes(data, at, end)
    return at


@njit(cache=True)
def _residuals(data: NDArray[np.uint8], at: int, end: int, encodings: Integers, out: Integers) -> int:
    """Read what the predictors leave of each field; return the place behind the frame, −1 where it is none."""
    field, fields = 0, len(encodings)
    group = np.zeros(4, dtype=np.int64)
    while field < fields and at >= 0:
        encoding = encodings[field]
        taken = 1
        if encoding == 0:
            out[field], at = _signed_bytes(data, at, end)
        elif encoding == 1:
            out[field], at = _unsigned_bytes(data, at, end)
        elif encoding == 3:
            value, at = _unsigned_bytes(data, at, end)
            out[field] = -_signed(value, 14)
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


@njit(cache=True)
def _mean(one: int, other: int) -> int:
    """Return the mean as the firmware's integers have it, rounded towards zero."""
    total = one + other
    return total // 2 if total >= 0 else -((-total) // 2)


@njit(cache=True)
def _following(iteration: int, settings: Integers) -> int:
    """Return the number of the next loop that is logged."""
    for number in range(iteration + 1, iteration + 1 + min(settings[KEY_INTERVAL], settings[DENOMINATOR])):
        within = number % settings[KEY_INTERVAL]
        rest = (within + settings[NUMERATOR] - 1) % settings[DENOMINATOR]
        if within == 0 or rest < settings[NUMERATOR]:
            return number
    return iteration + 1


@njit(cache=True)
def _predict(
    values: Integers,
    predictors: Integers,
    signs: Integers,
    last: Integers,
    before: Integers,
    settings: Integers,
    time: int,
    home: Integers,
) -> None:
    """Add to what was read what was predicted, as 32-bit numbers.

    Args:
        values: of a frame, in place.
        predictors: by field.
        signs: 1 where a field has a sign.
        last: the frame before.
        before: the one before that.
        settings: see the places above.
        time: of the last main frame.
        home: the GPS coordinates of the place of start.
    """
    coordinates = 0
    for field in range(len(values)):
        predictor = predictors[field]
        added = 0
        if predictor == 1:
            added = last[field]
        elif predictor == 2:
            added = 2 * last[field] - before[field]
        elif predictor == 3:
            added = _mean(last[field], before[field])
        elif predictor == 4:
            added = settings[MIN_THROTTLE]
        elif predictor == 5:
            added = values[settings[MOTOR]]
        elif predictor == 6:
            added = _following(last[field], settings)
        elif predictor == 7:
            added = home[min(coordinates, 1)]
            coordinates += 1
        elif predictor == 8:
            added = 1500
        elif predictor == 9:
            added = settings[BATTERY]
        elif predictor == 10:
            added = time
        elif predictor == 11:
            added = settings[MIN_MOTOR]
        total = (values[field] + added) & _WORD
        values[field] = _signed(total, 32) if signs[field] else total


@njit(cache=True)
def _event(data: NDArray[np.uint8], at: int, end: int, state: Integers) -> int:
    """Return the place behind an event, −1 where it is unknown; put down that the log is closed, or when it resumed."""
    if at >= end:
        return -1
    kind = data[at]
    if kind == 255:
        for place in range(len(_END_OF_LOG)):
            if at + place >= end or data[at + place] != _END_OF_LOG[place]:
                return -1
        state[_CLOSED] = 1
        return at + len(_END_OF_LOG)
    at += 1
    if kind == 13 and at < end and data[at] & 0x80:  # a setting was adjusted in flight: a 32-bit float
        return at + 5 if at + 5 <= end else -1
    numbers = 0
    if kind == 0 or kind == 15 or kind == 40:  # a beep to synchronise; disarmed; a fault of the sensors
        numbers = 1
    elif (
        kind == 13 or kind == 14 or kind == 30
    ):  # setting, value; resumed at loop, time; flight mode, the one before
        numbers = 2
    value = 0
    for _ in range(numbers):
        if at >= 0:
            value, at = _unsigned_bytes(data, at, end)
    if kind == 14 and at >= 0:
        state[_TIME] = value
    return at if numbers > 0 else -1


@njit(cache=True)
def _kind_at(data: NDArray[np.uint8], at: int) -> int:
    """Return the kind of the frame that begins at a place."""
    for kind in range(len(_LETTERS)):
        if data[at] == _LETTERS[kind]:
            return kind
    return OTHER


@njit(cache=True)
def _is_in_time(values: Integers, kind: int, settings: Integers, state: Integers) -> bool:
    """Whether the time of a main frame follows the one before."""
    passed = (values[settings[TIME]] - state[_TIME]) & _WORD
    if state[_TIME] < 0 or passed <= _LONGEST_LEAP:
        return True
    state[_IGNORED] += kind == INTRA
    return kind == INTRA and state[_IGNORED] > _KEYS_IGNORED


@njit(cache=True)
def _keep(values: Integers, rows: NDArray[np.int32], number: int) -> bool:
    """Write a frame into its row; return whether there was room."""
    if number >= len(rows):
        return False
    for field in range(len(values)):
        rows[number, field] = np.int32(_signed(values[field], 32))
    return True


@njit(cache=True)
def _take(
    values: Integers,
    kind: int,
    last: Integers,
    before: Integers,
    settings: Integers,
    rows: tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.int32]],
    times: Integers,
    origin: Integers,
    state: Integers,
) -> None:
    """Keep a sound frame, and what the ones behind it are predicted from; the arguments are those of `decode`."""
    if kind <= INTER:
        state[_TIME], state[_IGNORED] = values[settings[TIME]], 0
        state[_IN_STEP], state[_KEYED] = 1, 1
        before[:] = values if kind == INTRA else last
        last[:] = values
        state[_ROWS] += _keep(values, rows[0], state[_ROWS])
    elif kind == SLOW and _keep(values, rows[1], state[_ROWS + 1]):
        times[0, state[_ROWS + 1]] = state[_TIME]
        state[_ROWS + 1] += 1
    elif kind == GPS and _keep(values, rows[2], state[_ROWS + 2]):
        times[1, state[_ROWS + 2]] = state[_TIME]
        state[_ROWS + 2] += 1
    elif kind == HOME:
        for place in range(min(2, len(values))):
            origin[place] = values[place]


@njit(cache=True)
def decode(
    data: NDArray[np.uint8],
    tables: tuple[Integers, Integers, Integers, Integers, Integers],
    settings: Integers,
    rows: tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.int32]],
    times: Integers,
) -> Integers:
    """Decode the frames of one log.

    A frame whose end is not the beginning of another one, or whose time goes back or leaps, is damaged. Then all is
    skipped to the next key frame (I), from which on the others can be predicted again.

    Args:
        data: the bytes behind the header.
        tables: encoding, predictor and sign of each field, (3, fields), of frames I, P, S, G and H.
        settings: see the places above.
        rows: for the main, the slow and the GPS frames, (most, fields) each.
        times: for the times of the last main frame before each slow and each GPS frame, (2, most), µs.

    Returns:
        How many main, slow and GPS frames were decoded, how many places are damaged, and whether the log was closed.
    """
    fields = tables[INTRA].shape[1]
    last, before = np.zeros(fields, dtype=np.int64), np.zeros(fields, dtype=np.int64)
    longest = max(fields, tables[SLOW].shape[1], tables[GPS].shape[1], tables[HOME].shape[1])
    buffer, origin = np.zeros(longest, dtype=np.int64), np.zeros(2, dtype=np.int64)
    state = np.zeros(_ROWS + 3, dtype=np.int64)
    state[_TIME], state[_IN_STEP] = -1, 1
    at, end = 0, len(data)
    while at < end and state[_CLOSED] == 0:
        kind, following = _kind_at(data, at), -1
        table = tables[min(kind, HOME)]
        values = buffer[: table.shape[1]]
        if kind == EVENT:
            following = _event(data, at + 1, end, state)
        elif kind == INTRA or (kind < EVENT and state[_IN_STEP] == 1 and len(values) > 0):
            following = _residuals(data, at + 1, end, table[0], values)
        if state[_CLOSED] == 0 and 0 <= following < end and _kind_at(data, following) == OTHER:
            following = -1
        if following >= 0 and kind < EVENT and (kind != INTER or state[_KEYED] == 1):
            _predict(values, table[1], table[2], last, before, settings, state[_TIME], origin)
            if kind > INTER or _is_in_time(values, kind, settings, state):
                _take(values, kind, last, before, settings, rows, times, origin, state)
            else:
                following = -1
        if following < 0:
            state[_DAMAGED] += state[_IN_STEP]
            state[_IN_STEP], state[_KEYED] = 0, 0
            following = at + 1
        at = following
    return np.array([state[_ROWS], state[_ROWS + 1], state[_ROWS + 2], state[_DAMAGED], state[_CLOSED]])
