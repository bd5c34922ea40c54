"""A file as a platform on the command line: `platform=arm.yaml`, `platform=robot.urdf joint=elbow`."""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from simgap.artifacts.plain_yaml import read_yaml
from simgap.errors import InputError
from simgap.robot_files import SUFFIXES, is_robot_file, read_robot_file

_YAML = (".yaml", ".yml")
_PLATFORM, _JOINT = "platform=", "joint="


def read_platform_file(path: Path, joint: str | None = None) -> dict[str, Any]:
    """Return the keys of a platform that a file describes.

    Args:
        path: of a YAML file with the keys of docs/contract.md, or of a URDF or MJCF file.
        joint: which joint of a URDF or MJCF file.

    Raises:
        InputError: when the file cannot be used, or a joint is named that no robot file has.
    """
    if is_robot_file(path):
        return read_robot_file(path, joint)
    if joint is not None:
        raise InputError("names a joint of a URDF or MJCF file", _JOINT + joint, f"{path} is none")
    content = read_yaml(path)
    if not isinstance(content, dict):
        raise InputError("is no mapping of keys", str(path), "see docs/contract.md")
    return content


def with_platform_files(overrides: Sequence[str]) -> list[str]:
    """Return overrides in which a file as a platform is an option that Hydra knows, and its joint is gone.

    Hydra then treats the file as any other platform: single keys may be changed, and several files be swept over.

    Raises:
        InputError: when a file cannot be used, or a joint is named without a robot file.
    """
    joints = [text.removeprefix(_JOINT) for text in overrides if text.startswith(_JOINT)]
    joint = joints[-1] if joints else None
    rest = [text for text in overrides if not text.startswith(_JOINT)]
    changed = [_registered(text, joint) for text in rest]
    if joint is not None and changed == rest:
        raise InputError("names a joint of a robot file", _JOINT + joint, "give platform=robot.urdf, too")
    return changed


def _registered(override: str, joint: str | None) -> str:
    """Return a choice of platforms, each file in it under a name."""
    if not override.startswith(_PLATFORM):
        return override
    choice = override.removeprefix(_PLATFORM)
    parts = [choice] if Path(choice).exists() else choice.split(",")
    return _PLATFORM + ",".join(_register(part, joint) if _is_file(part) else part for part in parts)


def _is_file(choice: str) -> bool:
    return Path(choice).suffix.lower() in (*_YAML, *SUFFIXES)


def _register(choice: str, joint: str | None) -> str:
    from hydra.core.config_store import ConfigStore

    from simgap.runner.mistakes import configuration_mistakes

    name = re.sub(r"\W+", "_", f"file {choice} {joint or ''}".strip(), flags=re.ASCII)
    content = _literal(read_platform_file(Path(choice).expanduser(), joint))
    with configuration_mistakes(choice):
        ConfigStore.instance().store(group="platform", name=name, node=content, provider=choice)
    return name


def _literal(value: Any) -> Any:
    """Return values in which text is nothing but text: OmegaConf would replace `${...}`."""
    if isinstance(value, dict):
        return {key: _literal(entry) for key, entry in value.items()}
    if isinstance(value, list):
        return [_literal(entry) for entry in value]
    return value.replace("${", r"\${") if isinstance(value, str) else value
