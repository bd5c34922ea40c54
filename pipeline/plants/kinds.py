"""Common interface for recording concealed cases of every kind."""

import dataclasses
import difflib
from collections.abc import Callable, Mapping
from typing import Any, get_origin, get_type_hints

from simgap.errors import InputError
from simgap.plants.case import PlantCase
from simgap.plants.joint.case import JointCase
from simgap.plants.onset import with_onset
from simgap.plants.rig.case import RigCase
from simgap.plants.swerve.case import SwerveCase
from simgap.platforms import Joint, Quadrotor, Swerve
from simgap.recordings.recording import Recording

Case = PlantCase | JointCase | SwerveCase | RigCase

CASES: dict[str, type[PlantCase] | type[JointCase] | type[SwerveCase] | type[RigCase]] = {
    "quadrotor": PlantCase,
    "joint": JointCase,
    "swerve": SwerveCase,
    "attitude_rig": RigCase,
}
"""The case of each plant: that of a kind of platform, or another one of such a machine."""

_MACHINES = {"attitude_rig": "quadrotor"}
"""The kind of platform of a plant that is called otherwise."""


def case_from_config(kind: str, values: Mapping[str, Any], where: str = "record") -> Case:
    """Build the case of a kind of platform from a mapping, such as the configuration group `record` is.

    The key `plant` chooses another plant than the one that is called as the kind is.

    Raises:
        InputError: on an unknown plant or key, and on a value of the wrong type.
    """
    chosen = dict(values)
    plant = chosen.pop("plant", kind)
    if plant not in CASES:
        raise InputError(f"there is no plant {plant!r}", f"{where}.plant", f"use one of {', '.join(CASES)}")
    return _built(CASES[plant], chosen, where)


def _built(cls: type, values: Any, where: str) -> Any:
    if not isinstance(values, Mapping):
        raise InputError("a mapping of keys is needed here", where, "see conf/record")
    hints = get_type_hints(cls)
    for key in values:
        if key not in hints:
            near = difflib.get_close_matches(str(key), hints, n=1)
            remedy = f"did you mean {near[0]!r}?" if near else f"known keys: {', '.join(hints)}"
            raise InputError(f"unknown key {key!r}", where, remedy)
    return cls(**{str(key): _typed(hints[key], value, f"{where}.{key}") for key, value in values.items()})


def _typed(hint: Any, value: Any, where: str) -> Any:
    """Return a value as its field has it; mappings of effects are for the case itself to check."""
    if dataclasses.is_dataclass(hint):
        return _built(hint, value, where)  # type: ignore[arg-type]
    if hint is float and isinstance(value, int) and not isinstance(value, bool):
        return float(value)
    wanted = get_origin(hint) or hint
    if not isinstance(value, wanted) or (wanted is int and isinstance(value, bool)):
        raise InputError(f"must be of type {wanted.__name__}, is {value!r}", where, "correct it")
    return value


def record_case(
    case: Case, platform: Quadrotor | Swerve | Joint, seed: int
) -> tuple[Recording, dict[str, Any]]:
    """Record runs of the plant that a case conceals.

    Two cases with one seed are told to do the same, with the same noise: they differ by what they conceal alone.

    Args:
        case: what is concealed and how it is recorded.
        platform: what the world is told of the plant.
        seed: of every random draw.

    Returns:
        The recording, whose `source` names the hash of the key, and the key.

    Raises:
        InputError: when case and platform do not fit, or the case cannot be run.
    """
    plant = next(name for name, cls in CASES.items() if isinstance(case, cls))
    if _MACHINES.get(plant, plant) != platform.kind:
        remedy = "choose another record=NAME"
        raise InputError(f"is a case of another machine than a {platform.kind}", "record", remedy)
    record = _recorder(plant)
    if isinstance(case, RigCase):
        return record(case, platform, seed)
    return with_onset(case, lambda each: record(each, platform, seed))


def _recorder(plant: str) -> Callable[..., tuple[Recording, dict[str, Any]]]:
    """Return what runs a plant, loaded only now: whoever asks for a case alone need not wait for it."""
    if plant == "quadrotor":
        from simgap.plants.fly import fly

        return fly
    if plant == "attitude_rig":
        from simgap.plants.rig.record import record_rig

        return record_rig
    if plant == "joint":
        from simgap.plants.joint.record import record_joint

        return record_joint
    from simgap.plants.swerve.record import record_swerve

    return record_swerve
