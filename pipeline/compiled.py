"""Floor 0: a loop over the bytes of a file, compiled by numba where there are many."""

import inspect
from collections.abc import Callable
from functools import lru_cache
from typing import Any

LARGE = 1 << 23  # bytes; over fewer, Python's own loop ends before numba is imported


def for_size(loop: Callable[..., Any], size: int) -> Callable[..., Any]:
    """Return a loop, compiled if it goes over many bytes; the results are the same.

    Args:
        loop: a function that calls no other one, and takes memoryviews and numbers. Compiled it does not check places.
        size: bytes of the file.
    """
    return _compiled(loop) if size >= LARGE else loop


@lru_cache
def _compiled(loop: Callable[..., Any]) -> Callable[..., Any]:
    from numba import njit

    return njit(cache=True)(inspect.unwrap(loop))  # type: ignore[no-any-return]  # without checks of its types
