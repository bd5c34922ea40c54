"""Progress of long work: a bar on a terminal, plain lines in a log."""

import logging
import sys
import time
from collections.abc import Iterable, Iterator, Sized
from typing import TypeVar

Item = TypeVar("Item")

QUIET_SECONDS = 2.0
LINE_SECONDS = 10.0

_log = logging.getLogger("simgap")


def progress(iterable: Iterable[Item], label: str, total: int | None = None) -> Iterator[Item]:
    """Yield the items of `iterable` and show how many are done, once this has taken more than two seconds.

    Args:
        iterable: what is worked through.
        label: what a person calls the work.
        total: the number of items, where `iterable` does not know its length.
    """
    if total is None and isinstance(iterable, Sized):
        total = len(iterable)
    if sys.stderr.isatty():
        from tqdm import tqdm

        yield from tqdm(iterable, desc=label, total=total, delay=QUIET_SECONDS, leave=False)
    else:
        yield from _with_lines(iterable, label, total)


class Pace:
    """Logs where work of unknown length is, at most every ten seconds."""

    def __init__(self, label: str) -> None:
        self.label = label
        self._start = self._told = time.monotonic()

    def tell(self, where: str) -> None:
        """Log the current step, if ten seconds have passed."""
        now = time.monotonic()
        if now - self._told >= LINE_SECONDS:
            _log.info("%s: %s after %.0f s", self.label, where, now - self._start)
            self._told = now


def _with_lines(iterable: Iterable[Item], label: str, total: int | None) -> Iterator[Item]:
    start = time.monotonic()
    due = start + QUIET_SECONDS
    for done, item in enumerate(iterable):
        now = time.monotonic()
        if now >= due:
            count = f"{done} of {total}" if total is not None else str(done)
            _log.info(
                "%s: %s after %.0f s%s", label, count, now - start, _remaining_time(done, total, now - start)
            )
            due = now + LINE_SECONDS
        yield item


def _remaining_time(done: int, total: int | None, seconds: float) -> str:
    """Return the remaining time at the present rate; empty where it is unknown."""
    if total is None or done == 0:
        return ""
    left = seconds / done * (total - done)
    return f", about {left / 60.0:.0f} min left" if left >= 90.0 else f", about {left:.0f} s left"
