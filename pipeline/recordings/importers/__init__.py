"""Importers: one file per format; each converts to SI units and the frames of the contract."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from simgap.errors import InputError
from simgap.recordings.importers import (
    arm_motion,
    crazyflie_log,
    nanobench,
    nanodrone,
    pendulum_json,
    sysid_json,
    table,
    wheel_excitation,
)
from simgap.recordings.recording import Recording

Importer = Callable[[Sequence[Path], Mapping[str, Any]], Recording]

IMPORTERS: dict[str, Importer] = {
    "table": table.read,
    "sysid_json": sysid_json.read,
    "nanodrone": nanodrone.read,
    "nanobench": nanobench.read,
    "crazyflie_log": crazyflie_log.read,
    "pendulum_json": pendulum_json.read,
    "wheel_excitation": wheel_excitation.read,
    "arm_motion": arm_motion.read,
}


def importer(name: str) -> Importer:
    """Return the importer of a format.

    Raises:
        InputError: when there is none of that name.
    """
    if name not in IMPORTERS:
        raise InputError(
            f"unknown importer {name!r}", "dataset.importer", f"use one of {', '.join(IMPORTERS)}"
        )
    return IMPORTERS[name]


__all__ = ["IMPORTERS", "Importer", "importer"]
