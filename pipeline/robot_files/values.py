"""Numbers and orientations in the attributes of an element."""

import math
from collections.abc import Mapping

import numpy as np

from simgap.errors import InputError


def numbers(attributes: Mapping[str, str], key: str, default: str, where: str, least: int = 1) -> np.ndarray:
    """Return the numbers of an attribute, shape (n,).

    Args:
        attributes: of an element.
        key: of the attribute.
        default: where it is absent.
        where: the place to name in an error.
        least: how many there have to be.

    Raises:
        InputError: when one is no finite number, or there are too few.
    """
    text = attributes.get(key, default)
    try:
        values = np.array([float(word) for word in text.split()])
    except ValueError as error:
        raise InputError(f"{key}={text!r} is no list of numbers", where, "expand macros first") from error
    if not np.isfinite(values).all():
        raise InputError(f"{key}={text!r} is not finite", where, "correct the file")
    if len(values) < least:
        raise InputError(f"{key}={text!r} has fewer than {least} numbers", where, "correct the file")
    return values


def vector(attributes: Mapping[str, str], key: str, default: str, where: str) -> np.ndarray:
    """Return an attribute of exactly three numbers, shape (3,)."""
    values = numbers(attributes, key, default, where, least=3)
    if len(values) != 3:
        raise InputError(f"{key}={attributes[key]!r} has more than three numbers", where, "correct the file")
    return values


def number(attributes: Mapping[str, str], key: str, default: float, where: str) -> float:
    """Return the first number of an attribute."""
    return float(numbers(attributes, key, repr(default), where)[0])


def direction(attributes: Mapping[str, str], key: str, default: str, where: str) -> np.ndarray:
    """Return an attribute of three numbers at unit length, shape (3,)."""
    values = vector(attributes, key, default, where)
    return unit(values, f"{key}={attributes.get(key)!r}", where)


def unit(values: np.ndarray, what: str, where: str) -> np.ndarray:
    """Return a vector at unit length.

    Raises:
        InputError: when it has no direction.
    """
    length = float(np.linalg.norm(values))
    if not 0.0 < length < math.inf:
        raise InputError(f"{what} has no direction", where, "correct the file")
    return values / length
