"""Floor 0: checks of numbers that a person gives."""

from collections.abc import Iterable
from typing import Any

from simgap.errors import InputError


def check_positive(part: Any, keys: Iterable[str], where: str) -> None:
    """Refuse settings in which one of these numbers is zero or less."""
    for key in keys:
        if getattr(part, key) <= 0:
            raise InputError(f"must be positive, is {getattr(part, key)}", f"{where}.{key}", "correct it")


def check_not_negative(part: Any, keys: Iterable[str], where: str) -> None:
    """Refuse settings in which one of these numbers is negative."""
    for key in keys:
        if getattr(part, key) < 0:
            raise InputError("must not be negative", f"{where}.{key}", "give 0 or more")
