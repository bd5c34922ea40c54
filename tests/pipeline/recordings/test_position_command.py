"""A servo goes where it is told: what contradicts that is a sign or a unit."""

import numpy as np
import pandas as pd
import pytest

from simgap.consistency import contradictions
from simgap.recordings.recording import recording_from_frame

TIME = np.arange(400) / 50.0


def told(command: float = 1.0, position: float = 1.0, load: float = 0.0) -> pd.DataFrame:
    swing = np.sin(2.0 * TIME)
    late = 0.9 * np.sin(2.0 * TIME - 0.3)
    return pd.DataFrame(
        {"run": "one", "t": TIME, "position": position * late + load, "position_command": command * swing}
    )


@pytest.mark.parametrize(
    ("frame", "column", "suspected"),
    [
        (told(command=-1.0), "position", "sign"),
        (told(command=180 / np.pi), "position_command", "degrees"),
        (told(position=180 / np.pi), "position", "degrees"),
    ],
)
def test_a_command_of_another_sign_or_unit_contradicts_the_position(frame, column, suspected):
    (found,) = contradictions(recording_from_frame(frame, "joint"))
    assert (found.column, found.suspected) == (column, suspected)
    assert "\n" not in found.sentence


@pytest.mark.parametrize(
    "frame", [told(), told(load=1.5), told(position=0.4), told(position=0.0), told().iloc[:9]]
)
def test_lag_load_and_standstill_contradict_nothing(frame):
    assert contradictions(recording_from_frame(frame, "joint")) == []


def test_a_position_command_takes_the_unit_of_the_position():
    turning, sliding = (recording_from_frame(told(), "joint", sliding=slides) for slides in (False, True))
    assert turning.units["position_command"] == "rad"
    assert sliding.units["position_command"] == "m"
