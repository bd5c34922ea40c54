"""Of a recording that contradicts itself nothing is named: whatever were named there would be made up."""

import json
from dataclasses import replace

import pytest

from simgap.api.flow import diagnosed
from simgap.diagnosis.contract import diagnosis_document
from simgap.errors import InputError
from simgap.gap.settings import Gap
from simgap.recordings.cleaning.settings import Cleaning
from simgap.recordings.recording import Recording
from simgap.recordings.split import Split
from tests.contract_checker import check_diagnosis
from tests.pipeline.gap.problems import named, quick
from tests.pipeline.gap.recordings import Plant, joint_recording, joint_simulator


def scaled(recording: Recording, column: str, factor: float) -> Recording:
    return replace(recording, frame=recording.frame.assign(**{column: factor * recording.frame[column]}))


@pytest.mark.slow
def test_nothing_is_named_and_the_contradiction_is_said_first():
    backwards = scaled(joint_recording(Plant(friction=0.3, viscous=0.05)), "voltage", -1.0)
    found = quick(backwards, joint_simulator())
    assert (found.verdict, named(found), found.unnamed) == ("contradiction", [], [])
    assert (found.contradictions[0].column, found.contradictions[0].suspected) == ("voltage", "sign")
    assert found.warnings[0] == found.contradictions[0].sentence
    check_diagnosis(json.loads(json.dumps(diagnosis_document(found))), "joint")


def test_what_cannot_even_be_cleaned_is_refused_with_the_cause():
    raw = replace(joint_recording(Plant(friction=0.3)), cleaned=False)
    slow = replace(
        raw,
        frame=raw.frame.assign(t=1000.0 * raw.frame["t"]).drop(
            columns=["segment", "filled"], errors="ignore"
        ),
    )
    with pytest.raises(InputError, match=r"column 't'.*unit: ms"):
        diagnosed(slow, joint_simulator(), Gap(), Cleaning(max_gap=0.1), Split())
