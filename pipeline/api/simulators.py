"""Where a machine comes from: a folder, or a platform and effects of the catalogue."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from simgap.api.inputs import platform_config
from simgap.api.machine import Machine
from simgap.effects import Effect, effects_of, kinds
from simgap.errors import InputError
from simgap.platforms.settings import SimulatorSettings
from simgap.simulation import read_simulator
from simgap.simulation.build import build_simulator as built_simulator

if TYPE_CHECKING:
    from simgap.api.inputs import PlatformLike


def load_simulator(path: str | Path, command: str | None = None) -> Machine:
    """Load a simulator from the folder that `simgap diagnose` or `Answer.save` wrote. Loading executes nothing.

    Args:
        path: the folder that holds `simulator.yaml`, or the folder of the answer around it.
        command: what drives it, see `Machine`.

    Raises:
        InputError: when the folder holds no simulator, or the platform cannot be driven so.
    """
    folder = Path(path).expanduser()
    inside = folder / "simulator"
    whole = not (folder / "simulator.yaml").exists() and (inside / "simulator.yaml").exists()
    return Machine(read_simulator(inside if whole else folder), command)


def build_simulator(
    platform: "PlatformLike",
    effects: Mapping[str, Mapping[str, float]] | None = None,
    command: str | None = None,
    position_unit: str = "rad",
    joint: str | None = None,
) -> Machine:
    """Build a simulator from a platform and, if wanted, effects of the catalogue.

    Args:
        platform: the path of a YAML, URDF or MJCF file, a mapping of keys, a dataclass of `simgap.platforms` or the
            name of a platform that the package brings.
        effects: effect to parameter to value, in the units of `simgap.catalogue`; what is left out has its default.
        command: what drives it, see `Machine`.
        position_unit: of a joint, rad or m.
        joint: which joint of a URDF or MJCF file; None for the only one that moves.

    Raises:
        InputError: on a wrong platform, an unknown effect or parameter, or where the platform cannot be driven so.
    """
    if position_unit not in ("rad", "m"):
        raise InputError(f"is {position_unit!r}", "position_unit", "use rad or m")
    settings = SimulatorSettings(effects={name: dict(values) for name, values in (effects or {}).items()})
    units = {"position": position_unit}
    return Machine(built_simulator(platform_config(platform, joint), settings, units), command)


def catalogue(kind: str) -> tuple[Effect, ...]:
    """Return every effect that a diagnosis of a kind may name or a simulator may be given, in alphabetical order.

    An effect has `key`, `acts_on`, `parameters` (each with `name`, `unit`, `default`, `low`, `high`), `formula`,
    `source` and `excitation`, the manoeuvre that shows it; see `simgap.effects.Effect`.

    Args:
        kind: `quadrotor`, `swerve` or `joint`.

    Raises:
        InputError: when there is no such kind.
    """
    if kind not in kinds():
        raise InputError(f"unknown kind {kind!r}", remedy=f"use one of {', '.join(kinds())}")
    return effects_of(kind)
