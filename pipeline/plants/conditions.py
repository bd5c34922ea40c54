"""Checks that all kinds of cases share."""

from dataclasses import fields
from typing import Any

from simgap.checks import check_not_negative
from simgap.errors import InputError


def check_listed(names: list[str], known: tuple[str, ...], where: str, least: int = 1) -> None:
    """Refuse a list with a name that is not known, or too short a one."""
    for name in names:
        if name not in known:
            raise InputError(f"unknown entry {name!r}", where, f"known: {', '.join(known)}")
    if len(names) < least:
        raise InputError("is empty", where, f"choose from {', '.join(known)}")


def check_gentlest(gentlest: float, where: str) -> None:
    """Refuse a share of the wildest run that the gentlest one cannot be."""
    if not 0 < gentlest <= 1:
        raise InputError(f"must be over 0, at most 1, is {gentlest}", f"{where}.gentlest", "correct it")


def check_logger(rate: float, jitter: float, dropped: float, where: str) -> None:
    """Refuse a logger whose samples would not be in order."""
    if rate > 1000:
        raise InputError(f"must be at most 1000, is {rate}", f"{where}.rate", "give Hz")
    if not 0 <= dropped < 0.9:
        raise InputError(f"must be from 0 to 0.9, is {dropped}", f"{where}.dropped", "give a share")
    if not 0 <= jitter * rate < 0.2:
        raise InputError(
            f"must be under a fifth of the time step, is {jitter}", f"{where}.jitter", "give seconds"
        )


def check_noise(sensors: Any, where: str) -> None:
    """Refuse negative noise."""
    check_not_negative(sensors, (entry.name for entry in fields(sensors)), where)
