"""From overrides on the command line to the typed configuration of a stage."""

import re
from collections.abc import Sequence
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from simgap.artifacts.project import CONFIGURATION
from simgap.errors import InputError
from simgap.runner.config import StageConfig
from simgap.runner.mistakes import configuration_mistakes
from simgap.runner.platform_file import with_platform_files
from simgap.runner.project import nearest

if TYPE_CHECKING:
    from hydra._internal.hydra import Hydra
    from omegaconf import DictConfig

Config = TypeVar("Config", bound=StageConfig)

ROOT_CONFIG = "config"

_TEXT_KEYS = ("recording", "output")
_PLAIN_VALUE = re.compile(r"[\w./+-]*")


def compose(overrides: Sequence[str], config_dir: str | None = None) -> dict[str, Any]:
    """Return the composed and resolved configuration of all stages.

    Args:
        overrides: Hydra's, as typed.
        config_dir: a person's own folder of configuration groups; it goes before the project's.

    Raises:
        InputError: on an unknown key, group or option, and on what cannot be read.
    """
    from hydra.core.override_parser.overrides_parser import OverridesParser
    from hydra.types import RunMode

    prepared = prepare_overrides([quote_text(override) for override in overrides], config_dir)
    single = [override for override in prepared if _is_single(override)]
    others = [override for override in prepared if not _is_single(override)]
    with configuration_mistakes():
        hydra = open_hydra(config_dir)
        root = hydra.compose_config(ROOT_CONFIG, others, RunMode.RUN, with_log_configuration=False)
        # Hydra would take `output=DIR` for a choice in a group where a person's folder has a subfolder `output`.
        for entry in OverridesParser.create().parse_overrides(single):
            root[entry.key_or_group] = entry.value()
        return plain(root)


def plain(root: "DictConfig") -> dict[str, Any]:
    """Return a composed configuration as plain values, without Hydra's own part."""
    from omegaconf import OmegaConf

    with configuration_mistakes():
        tree = OmegaConf.masked_copy(root, [str(key) for key in root if key != "hydra"])
        values = OmegaConf.to_container(tree, resolve=True)
    assert isinstance(values, dict)
    return {str(key): value for key, value in values.items()}


def typed(config_class: type[Config], values: dict[str, Any]) -> Config:
    """Return what a stage reads of the composed configuration, checked against its dataclass.

    Raises:
        InputError: on a key that the dataclass does not have and on a value of the wrong type.
    """
    from omegaconf import OmegaConf

    merged = OmegaConf.structured(config_class)
    for key in (field.name for field in fields(config_class) if field.name in values):
        with configuration_mistakes(key):
            merged = OmegaConf.merge(merged, {key: values[key]})
    with configuration_mistakes():
        config = OmegaConf.to_object(merged)
    assert isinstance(config, config_class)
    return config


def open_hydra(config_dir: str | None = None) -> "Hydra":
    """Return a fresh Hydra that looks in a person's folder, then in the project's.

    Raises:
        InputError: when the person's folder is not there.
    """
    from hydra._internal.hydra import Hydra
    from hydra._internal.utils import create_config_search_path
    from hydra.core.global_hydra import GlobalHydra

    GlobalHydra.instance().clear()
    path = create_config_search_path(f"file://{CONFIGURATION}")
    if config_dir is not None:
        if not Path(config_dir).is_dir():
            raise InputError(
                "is not a directory", config_dir, "give --config-dir a folder of configuration groups"
            )
        path.prepend("command-line", f"file://{Path(config_dir).resolve()}")
    return Hydra.create_main_hydra2("simgap", path)


def quote_text(override: str) -> str:
    """Quote the path in `recording=PATH`, so that a person need not quote spaces and brackets."""
    key, equals, value = override.partition("=")
    if key not in _TEXT_KEYS or not equals or _PLAIN_VALUE.fullmatch(value) or value[:1] in "'\"$":
        return override
    escaped = value.replace("\\", "\\\\").replace("'", "\\'")
    return f"{key}='{escaped}'"


def prepare_overrides(overrides: Sequence[str], config_dir: str | None = None) -> list[str]:
    """Return the overrides such that Hydra accepts every key: the dataclasses know which there are.

    Raises:
        InputError: when the first part of a key is nothing that `conf/config.yaml` has, or a platform's file is no use.
    """
    folders = [CONFIGURATION] + ([Path(config_dir)] if config_dir else [])
    groups = {
        entry.name for folder in folders if folder.is_dir() for entry in folder.iterdir() if entry.is_dir()
    }
    known = root_keys() | groups
    return [_prepare(override, known, groups) for override in with_platform_files(overrides)]


def _is_single(override: str) -> bool:
    return override.partition("=")[0] in {f"++{key}" for key in _single_keys()}


def _single_keys() -> set[str]:
    """Return the top-level keys that hold one value each."""
    return {key for key, value in _root().items() if not isinstance(value, dict | list)}


def _prepare(override: str, known: set[str], groups: set[str]) -> str:
    key, equals, value = override.partition("=")
    first, dot, _ = key.lstrip("+~").partition(".")
    first = re.split("[/@]", first)[0]
    if not equals and not key.startswith("~"):
        raise InputError("is not of the form key=value", override, "see --help")
    if first not in known and first != "hydra":
        raise InputError(f"unknown key {first!r}", override, nearest(first, known))
    is_selection = (first in groups - _single_keys() and not dot) or first == "hydra"
    if is_selection and Path(value).suffix in (".yaml", ".yml"):
        folder = f"--config-dir DIR, where DIR/{first} holds the file"
        raise InputError(
            "is a file, and a name is needed", override, f"use {first}={Path(value).stem} {folder}"
        )
    return override if is_selection or key[0] in "+~" else f"++{key}={value}"


def root_keys() -> set[str]:
    """Return the top-level keys of the configuration: those of the root file and its groups."""
    root = _root()
    entries = [key for entry in root.pop("defaults") if isinstance(entry, dict) for key in entry]
    names = {key.removeprefix("optional ") for key in entries if not key.startswith("override ")}
    return (set(root) | names) - {"hydra"}


def _root() -> dict[str, Any]:
    import yaml

    return yaml.safe_load((CONFIGURATION / f"{ROOT_CONFIG}.yaml").read_text(encoding="utf-8"))
