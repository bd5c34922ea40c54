"""Compiled decoder of the frames of a blackbox log.

Source: "Blackbox logging internals", betaflight.com/docs/development/blackbox-internals.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from simgap.logs.readers.blackbox_encodings import Integers, residuals, signed, unsigned_bytes

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
        values[field] = signed(total, 32) if signs[field] else total


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
            value, at = unsigned_bytes(data, at, end)
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
        rows[number, field] = np.int32(signed(values[field], 32))
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
    group, state = np.zeros(4, dtype=np.int64), np.zeros(_ROWS + 3, dtype=np.int64)
    state[_TIME], state[_IN_STEP] = -1, 1
    at, end = 0, len(data)
    while at < end and state[_CLOSED] == 0:
        kind, following = _kind_at(data, at), -1
        table = tables[min(kind, HOME)]
        values = buffer[: table.shape[1]]
        if kind == EVENT:
            following = _event(data, at + 1, end, state)
        elif kind == INTRA or (kind < EVENT and state[_IN_STEP] == 1 and len(values) > 0):
            following = residuals(data, at + 1, end, table[0], values, group)
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
