"""The nominal simulator: a platform with identified corrections and the known effects."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from simgap.effects import effect_by_key
from simgap.errors import InputError
from simgap.platforms import platform_from_config
from simgap.platforms.settings import SimulatorSettings
from simgap.simulation.identified import with_identified
from simgap.simulation.simulator import FittedEffect, Simulator


def build_simulator(
    platform: Mapping[str, Any],
    settings: SimulatorSettings,
    units: Mapping[str, str],
    identified: Path | None = None,
) -> Simulator:
    """Build the nominal simulator, from which the diagnosis starts.

    Args:
        platform: the keys of docs/contract.md.
        settings: effects that are known already.
        units: of the recording's channels; a joint slides where its position is in metres.
        identified: parameters that sysid found, to be used in place of the platform's.

    Raises:
        InputError: on a wrong platform, an unknown effect or a wrong parameter name.
    """
    built = platform_from_config(platform)
    effects = tuple(_known(built.kind, key, values) for key, values in settings.effects.items())
    if identified is not None:
        built, found = with_identified(built, identified)
        effects = (*(f for f in found if f.effect.key not in settings.effects), *effects)
    return Simulator(built, effects, units.get("position", "rad"))


def _known(kind: str, key: str, values: Mapping[str, float]) -> FittedEffect:
    effect = effect_by_key(kind, key)
    names = [parameter.name for parameter in effect.parameters]
    for name in values:
        if name not in names:
            raise InputError(
                f"unknown parameter {name!r}", f"simulator.effects.{key}", f"use {', '.join(names)}"
            )
    return FittedEffect(effect, {**effect.defaults(), **effect.completed(values)}, known=True)
