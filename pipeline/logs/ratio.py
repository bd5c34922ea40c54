"""Numbers of the platform in a mapping: an encoder behind a gear counts turns of the wheel, not of the motor."""

import re
from collections.abc import Mapping as AbstractMapping
from dataclasses import replace
from typing import Any

from simgap.errors import InputError
from simgap.logs.mapping import Mapping, Source

_TERM = re.compile(r"[A-Za-z_]+(\.[A-Za-z_]+)*")


def with_ratios(mapping: Mapping, platform: AbstractMapping[str, Any] | None) -> Mapping:
    """Return a mapping whose ratios have become part of its scales.

    Args:
        mapping: as a person or a layout gives it.
        platform: its keys, as docs/contract.md lists them; None where no platform is known.

    Raises:
        InputError: when a ratio names no number of the platform.
    """
    if all(source.ratio is None for source in mapping.columns.values()):
        return mapping
    columns = {name: _scaled(name, source, platform) for name, source in mapping.columns.items()}
    return replace(mapping, columns=columns)


def without_ratios(mapping: Mapping) -> Mapping:
    """Return a mapping as if every ratio were one: its recording has the runs and the times, not the sizes."""
    return replace(
        mapping, columns={name: replace(source, ratio=None) for name, source in mapping.columns.items()}
    )


def _scaled(column: str, source: Source, platform: AbstractMapping[str, Any] | None) -> Source:
    if source.ratio is None:
        return source
    return replace(source, scale=source.scale * _value(source.ratio, platform, column), ratio=None)


def _value(ratio: str, platform: AbstractMapping[str, Any] | None, column: str) -> float:
    """Return the product of the numbers that a text names, as `drive.gear_ratio / wheel_radius`."""
    where = f"mapping, {column}, ratio"
    value = 1.0
    parts = ["*", *re.split("([*/])", ratio.replace(" ", ""))]
    for sign, name in zip(parts[::2], parts[1::2], strict=True):
        if not _TERM.fullmatch(name):
            raise InputError(
                f"{ratio!r} is no ratio", where, "write drive.gear_ratio, or a product with * and /"
            )
        if platform is None:
            raise InputError(
                f"{name} of the platform is needed",
                where,
                "give platform=NAME, or scale: NUMBER in its place",
            )
        number = _number(name, platform, where)
        value = value / number if sign == "/" else value * number
    return value


def _number(name: str, platform: AbstractMapping[str, Any], where: str) -> float:
    content: Any = platform
    for key in name.split("."):
        content = content.get(key) if isinstance(content, AbstractMapping) else None
    if isinstance(content, bool) or not isinstance(content, int | float) or not content:
        raise InputError(
            f"the platform has no number {name}", where, "add it to the platform, or give scale: NUMBER"
        )
    return float(content)
