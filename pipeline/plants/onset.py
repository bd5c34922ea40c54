"""Something that breaks between two runs: the runs before hold nothing concealed."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pandas as pd

from simgap.errors import InputError
from simgap.plants.case import PlantCase
from simgap.plants.joint.case import JointCase
from simgap.plants.sealing import source_of
from simgap.plants.swerve.case import SwerveCase
from simgap.recordings.recording import Recording

Breaking = PlantCase | JointCase | SwerveCase
"""Cases whose effects may begin in a later run."""


def with_onset(
    case: Breaking, record: Callable[[Any], tuple[Recording, dict[str, Any]]]
) -> tuple[Recording, dict[str, Any]]:
    """Record a case whose effects act from `begins_in_run` on, and the runs before without them.

    Both parts are told to do the same, with the same noise.

    Args:
        case: what is concealed and how it is recorded.
        record: records a case of this machine.

    Returns:
        The recording, whose `source` names the hash of the key, and the key, which lists the runs in which they act.

    Raises:
        InputError: when there is no such run, or the case cannot be run.
    """
    case.check()
    if not 1 <= case.begins_in_run <= case.runs:
        raise InputError(
            f"there is no run {case.begins_in_run} among {case.runs}",
            "record.begins_in_run",
            "give 1 or more",
        )
    recording, key = record(case)
    if case.begins_in_run == 1:
        return recording, key
    before = record(_without_effects(case))[0].frame
    names = recording.runs[: case.begins_in_run - 1]
    after = recording.frame
    frame = pd.concat(
        [before[before["run"].isin(names)], after[~after["run"].isin(names)]], ignore_index=True
    )
    key = {**key, "acts_in_runs": recording.runs[case.begins_in_run - 1 :]}
    return replace(recording, frame=frame, source=source_of(key)), key


def _without_effects(case: Breaking) -> Breaking:
    """Return the same case with nothing concealed, flown the same way."""
    if isinstance(case, PlantCase):
        autopilot = "trimmed" if case.trimmed else "plain"
        return replace(case, effects={}, flights=case.flown, autopilot=autopilot)
    return replace(case, effects={})
