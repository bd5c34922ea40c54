"""Messages in JSON that are the same but for their numbers. Anything else is left to a parser."""

from collections.abc import Sequence

import numpy as np

from simgap.logs.readers.packed import Columns, Packed
from simgap.recordings.alike_texts import numbers_alike

_FIRST = 2  # 0 and 1 are also what false and true become


def numbered(between: Sequence[bytes]) -> bytes:
    """Return a message whose numbers are 2, 3, 4 and so on: what a parser makes of it tells where each number belongs.

    Args:
        between: what stands between its numbers, see `simgap.recordings.alike_texts.between_numbers`.
    """
    first, *others = between
    return first + b"".join(b"%d" % number + text for number, text in enumerate(others, _FIRST))


def columns_of_pattern(messages: Packed, between: Sequence[bytes], example: Columns) -> Columns | None:
    """Return the numbers of messages; None where one is another but for its numbers, or they bear stamps or booleans.

    Args:
        messages: in JSON.
        between: what stands between their numbers.
        example: what a parser finds in the message that is `numbered`.
    """
    ((names, places),) = example.blocks
    order = places[0].astype(np.int64) - _FIRST
    if example.stamps is not None or (order < 0).any():
        return None
    numbers = numbers_alike(messages.buffer, messages.begins, messages.sizes, between)
    if numbers is None:
        return None
    return Columns(np.arange(len(messages)), [(names, numbers[:, order])], None, example.long)
