"""A flight without its whole state: rotation, motors and thrust can be judged, and nothing that depends on place."""

from collections.abc import Mapping

from simgap.logs.proposal import Proposed
from simgap.recordings.contract import TOGETHER

_STATE = TOGETHER["quadrotor"]


def whole_or_none(columns: Mapping[str, Proposed]) -> tuple[dict[str, Proposed], list[str]]:
    """Return columns without position, velocity and attitude if one of them is missing, and a sentence on that."""
    there = [name for name in _STATE if name in columns]
    if len(there) in (0, len(_STATE)):
        return dict(columns), []
    groups = ", ".join(dict.fromkeys(name.rsplit("_", 1)[0] for name in there))
    note = (
        f"Position, velocity and attitude count together, and not all of them are there: {groups} is left out, and the "
        "rotation, the motors and the thrust are judged alone."
    )
    return {name: entry for name, entry in columns.items() if name not in _STATE}, [note]
