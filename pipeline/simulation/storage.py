"""Storage of a simulator: a readable `simulator.yaml`, and tensors of learned parts.

Loading runs nothing.
"""

import math
from pathlib import Path
from typing import Any

import yaml

from simgap.artifacts import hash_path
from simgap.artifacts.descriptions import read_tensors, write_description, write_tensors
from simgap.effects import Effect, effect_by_key
from simgap.errors import InputError
from simgap.platforms import Platform, Quadrotor, platform_from_config, platform_to_config
from simgap.simulation.driver import SimulatedDriver
from simgap.simulation.knn_residual import NearestNeighbours, RecordedResidual
from simgap.simulation.learned import DYNAMICS, RESIDUAL, Learned, LearnedReader
from simgap.simulation.simulator import FittedEffect, Simulator

_FILE = "simulator.yaml"
_SCHEMA = "simgap.simulator/1"
_TENSORS = "recorded_residual.safetensors"


def write_simulator(simulator: Simulator, folder: Path) -> None:
    """Write the simulator into a folder that is made if needed."""
    folder.mkdir(parents=True, exist_ok=True)
    content = {
        "schema": _SCHEMA,
        "position_unit": simulator.position_unit,
        "platform": platform_to_config(simulator.platform),
        "settings": dict(simulator.settings),
        "effects": [_describe(fitted, simulator.position_unit, folder) for fitted in simulator.effects],
    }
    if simulator.learned is not None:
        content["learned"] = _describe_learned(simulator.learned, folder)
    write_description(content, folder / _FILE)


def _describe_learned(learned: Learned, folder: Path) -> dict[str, Any]:
    own = folder / learned.folder
    learned.save(own)
    return {"role": learned.role, **learned.describe(), "folder": own.name, "sha256": hash_path(own)}


def _describe(fitted: FittedEffect, position_unit: str, folder: Path) -> dict[str, Any]:
    if isinstance(fitted.effect, RecordedResidual):
        return _describe_recorded(fitted.effect, folder)
    units = fitted.effect.units(position_unit)
    parameters = {}
    for name, value in fitted.values.items():
        parameters[name] = {"value": float(value), "unit": units[name]}
        if name in fitted.std:
            parameters[name]["std"] = float(fitted.std[name])
    described = {"effect": fitted.effect.key, "formula": fitted.effect.formula, "parameters": parameters}
    if isinstance(fitted.effect, SimulatedDriver):
        described |= {"effect": fitted.effect.name, "drives": fitted.effect.driven.key}
    return described | ({"known": True} if fitted.known else {})


def _describe_recorded(residual: RecordedResidual, folder: Path) -> dict[str, Any]:
    known = residual.neighbours
    tensors = {"inputs": known.inputs.float(), "outputs": known.outputs.float()}
    return {
        "effect": residual.key,
        "formula": residual.formula,
        "neighbours": known.count,
        "tensors": write_tensors(tensors, folder / _TENSORS),
        "known": True,
    }


def read_simulator(folder: Path, reader: LearnedReader | None = None) -> Simulator:
    """Read a simulator that `write_simulator` wrote.

    Args:
        folder: that it was written into.
        reader: of the learned part; None: the physics are read alone.

    Raises:
        InputError: when the file is missing, is not such a file or names an unknown effect, or a learned part is not
            the one that was written.
    """
    path = folder / _FILE
    try:
        content = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise InputError(
            f"no simulator can be read: {error}", str(path), "give the folder that build_sim wrote"
        ) from error
    if not isinstance(content, dict) or content.get("schema") != _SCHEMA:
        raise InputError(f"is not a {_SCHEMA} file", str(path), "give the folder that build_sim wrote")
    platform = platform_from_config(content.get("platform"), f"{path}: platform")
    try:
        effects = tuple(_fitted(platform, entry, folder) for entry in content["effects"])
        _require_once(effects)
        settings = {str(name): _number(value) for name, value in content["settings"].items()}
        if content["position_unit"] not in ("rad", "m"):
            raise ValueError(f"position_unit is {content['position_unit']!r}, neither rad nor m")
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise InputError(
            f"is damaged ({type(error).__name__}: {error})", str(path), "run build_sim again"
        ) from error
    learned = _learned(content.get("learned"), platform, folder, reader) if reader else None
    return Simulator(platform, effects, content["position_unit"], settings, learned)


def _learned(entry: Any, platform: Platform, folder: Path, reader: LearnedReader) -> Learned | None:
    if entry is None:
        return None
    own = folder / Learned.folder
    if not isinstance(entry, dict) or entry.get("role") not in (DYNAMICS, RESIDUAL):
        raise InputError("is damaged (learned)", str(folder / _FILE), "run build_sim again")
    if not own.is_dir() or hash_path(own) != entry.get("sha256"):
        raise InputError(
            "is not the model that the simulator was built with", str(own), "run build_sim again"
        )
    return reader(own, platform, entry["role"])


def _fitted(platform: Platform, entry: dict[str, Any], folder: Path) -> FittedEffect:
    if entry["effect"] == RecordedResidual.name and isinstance(platform, Quadrotor):
        return FittedEffect(_recorded(platform, entry, folder / _TENSORS), {}, known=True)
    effect, parameters = _effect(platform, entry), entry["parameters"]
    values = effect.completed({name: _number(entry["value"]) for name, entry in parameters.items()})
    if values.keys() != {parameter.name for parameter in effect.parameters}:
        raise ValueError(f"{effect.key} has the parameters {', '.join(p.name for p in effect.parameters)}")
    std = {name: float(parameter["std"]) for name, parameter in parameters.items() if "std" in parameter}
    return FittedEffect(effect, values, std, bool(entry.get("known")))


def _effect(platform: Platform, entry: dict[str, Any]) -> Effect:
    if entry["effect"] == SimulatedDriver.name:
        return SimulatedDriver(effect_by_key(platform.kind, str(entry["drives"])))
    return effect_by_key(platform.kind, str(entry["effect"]))


def _require_once(effects: tuple[FittedEffect, ...]) -> None:
    keys = [fitted.effect.key for fitted in effects]
    for key in keys:
        if keys.count(key) > 1:
            raise ValueError(f"{key} is there twice")


def _recorded(platform: Quadrotor, entry: dict[str, Any], file: Path) -> RecordedResidual:
    tensors = read_tensors(file, entry["tensors"], "identify the residual again")
    neighbours = NearestNeighbours(tensors["inputs"], tensors["outputs"], int(entry["neighbours"]))
    return RecordedResidual(neighbours, platform)


def _number(value: Any) -> float:
    if isinstance(value, bool) or not math.isfinite(float(value)):
        raise ValueError(f"{value!r} is not a finite number")
    return float(value)
