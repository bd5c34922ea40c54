"""What a person hands to the API, made into what the library works with."""

import dataclasses
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar, cast

from simgap.errors import InputError
from simgap.robot_files import is_robot_file, read_robot_file

if TYPE_CHECKING:
    import pandas as pd

    from simgap.platforms import Platform
    from simgap.recordings.recording import Recording
    from simgap.recordings.storage import Table

    RecordingLike = str | Path | pd.DataFrame | Mapping[str, Any] | Recording
    PlatformLike = str | Path | Mapping[str, Any] | Platform

Kind = TypeVar("Kind")
_YAML = (".yaml", ".yml")


def load_recording(
    recording: "RecordingLike",
    kind: str | None = None,
    units: Mapping[str, str] | None = None,
    mapping: str | Path | None = None,
    platform: Mapping[str, Any] | None = None,
) -> "Recording":
    """Read a recording and check it, without changing it.

    Args:
        recording: the path of a log of any format that docs/contract.md lists, a data frame or a mapping of columns;
            a table has `run`, `t` in seconds and the columns that docs/contract.md lists for its kind, one value per
            sample, in SI units.
        kind: `quadrotor`, `swerve` or `joint`; inferred from the columns where it is None and no file says it.
        units: the unit of each column of a data frame or mapping that has another one than the contract's, for example
            `{"position": "deg"}`. A joint with `{"position": "m"}` slides. A file declares its own units.
        mapping: path of a YAML file that says which signal of a log is which column; `simgap inspect` proposes one.
        platform: its keys, also in the short forms of a platform file; a log needs them that has speeds of the wheels
            and not of the motors.

    Returns:
        The samples in the contract's units, with a sentence for each doubt in `warnings`.

    Raises:
        InputError: when the recording cannot be used; the line names file, run, row and column.
    """
    from simgap.logs.opening import open_recording
    from simgap.platforms import plain_config
    from simgap.recordings.recording import Recording, recording_from_table

    if isinstance(recording, Recording):
        return recording
    if isinstance(recording, str | Path):
        if units:
            raise InputError("a file declares its own units", "units", "give units with a data frame")
        numbers = None if platform is None else plain_config(platform)
        return open_recording(Path(recording).expanduser(), kind, Path(mapping) if mapping else None, numbers)
    if mapping:
        raise InputError("a mapping is of a file", "mapping", "rename the columns of the data frame")
    return recording_from_table(_table(recording, units or {}), kind)


def _table(columns: "pd.DataFrame | Mapping[str, Any]", units: Mapping[str, str]) -> "Table":
    import pandas as pd

    from simgap.recordings.storage import Table

    try:
        frame = pd.DataFrame(columns if isinstance(columns, pd.DataFrame) else dict(columns))
    except (TypeError, ValueError) as error:
        remedy = "give a path, a data frame, or a mapping from column to one value per sample"
        raise InputError(f"is no table ({error})", "recording", remedy) from error
    strange = next((name for name in units if name not in frame), None)
    if strange is not None:
        raise InputError(f"there is no column {strange!r}", "units", "name a column of the recording")
    return Table(frame.reset_index(drop=True), dict(units))


def platform_config(platform: "PlatformLike", joint: str | None = None) -> dict[str, Any]:
    """Return the keys of a platform, as docs/contract.md lists them.

    Args:
        platform: the path of a YAML, URDF or MJCF file, a mapping of keys, a `Quadrotor`, `Swerve` or `Joint` of
            `simgap.platforms`, or the name of a platform that the package brings (`racer`, `servo`, ...).
        joint: which joint of a URDF or MJCF file; None for the only one that moves.

    Raises:
        InputError: when there is no such file, name or joint, or the file cannot be used.
    """
    if isinstance(platform, str | Path) and is_robot_file(platform):
        return read_robot_file(Path(platform).expanduser(), joint)
    if joint is not None:
        raise InputError(
            "names a joint of a URDF or MJCF file", "joint", "give the path of one as the platform"
        )
    if isinstance(platform, Mapping):
        return dict(platform)
    if isinstance(platform, str | Path):
        return read_option("platform", platform)
    if dataclasses.is_dataclass(platform):
        from simgap.platforms import platform_to_config

        return platform_to_config(cast("Platform", platform))
    raise InputError(
        f"a {type(platform).__name__} is no platform",
        "platform",
        "give a path, a mapping, a dataclass or a name",
    )


def read_option(group: str, choice: str | Path) -> dict[str, Any]:
    """Return the keys of one file of a configuration group: a person's own by its path, another one by its name.

    Raises:
        InputError: when there is no such file or name, or the file is not a mapping.
    """
    from simgap.artifacts.plain_yaml import read_yaml

    path = _option_path(group, choice)
    content = read_yaml(path)
    if not isinstance(content, dict):
        raise InputError("is no mapping of keys", str(path), "see docs/contract.md")
    return content


def _option_path(group: str, choice: str | Path) -> Path:
    from simgap.artifacts.project import CONFIGURATION
    from simgap.runner.project import nearest

    path = Path(choice).expanduser()
    if isinstance(choice, Path) or path.suffix in _YAML or path.name != str(choice):
        return path
    options = {file.stem: file for file in (CONFIGURATION / group).glob("*.yaml")}
    if choice not in options:
        remedy = f"{nearest(choice, options)} or give the path of a YAML file"
        raise InputError(f"there is no {choice!r}", group, remedy)
    return options[choice]


def settings_of(cls: type[Kind], given: object, where: str) -> Kind:
    """Return settings with what is given in place of their defaults.

    Args:
        cls: dataclass of the settings, with defaults.
        given: nested mappings of some of its keys.
        where: what to name in an error that knows no key.

    Raises:
        InputError: on an unknown key or a value of the wrong type, or on no mapping.
    """
    from omegaconf import OmegaConf

    from simgap.runner.mistakes import configuration_mistakes

    if not isinstance(given, Mapping):
        raise InputError(f"a {type(given).__name__} is no mapping of keys", where, "see the folder conf")
    with configuration_mistakes(where):
        settings = OmegaConf.to_object(OmegaConf.merge(OmegaConf.structured(cls), dict(given)))
    assert isinstance(settings, cls)
    return settings
