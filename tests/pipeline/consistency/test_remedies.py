"""The lines of a mapping that are given as a remedy do what undoing the fault does."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml

from simgap.artifacts.plain_yaml import read_yaml
from simgap.consistency.faults import faults_of
from simgap.consistency.samples import samples_of
from simgap.consistency.transformation import Transformation
from simgap.logs.apply import recording_of
from simgap.logs.mapping import completed, mapping_from_config
from simgap.logs.tabular import log_of_table
from simgap.platforms import platform_from_config
from simgap.recordings.contract import channel_units
from simgap.recordings.recording import Recording
from tests.pipeline.consistency.plants import ROOT, SERVO

SAID = "Say in the mapping"
ROWS = 12


def recording(kind: str, pulses: bool = False) -> Recording:
    """Return small numbers, each column at another phase; attitudes of norm one; commands of 0.2 to 0.9."""
    units = channel_units(kind)
    time = 0.01 * np.arange(ROWS)
    frame = pd.DataFrame({"run": "run", "t": time})
    for place, column in enumerate(units):
        frame[column] = 0.2 * np.sin(time + place) + 0.01 * place
    for head in ("attitude", "estimate_attitude"):
        parts = [f"{head}_{part}" for part in "wxyz"]
        if parts[0] in frame:
            frame[parts] /= np.linalg.norm(frame[parts], axis=1)[:, None]
    for column in (f"motor_command_{rotor}" for rotor in "1234"):
        if column in frame:
            share = np.linspace(0.2, 0.9, ROWS)
            frame[column] = 1000.0 + 1000.0 * share if pulses else share
    return Recording(frame, kind, units)


def remedies(good: Recording, platform: object) -> Iterator[Transformation]:
    """Yield one fault of each cause and group of columns whose remedy is a mapping; the time is not among them."""
    known = set()
    for fault in faults_of(samples_of(good), platform, sliding=False):
        key = (fault.suspected, fault.column)
        if fault.remedy.startswith(SAID) and fault.columns != ("t",) and key not in known:
            known.add(key)
            yield fault


def mapped(good: Recording, remedy: str) -> pd.DataFrame:
    """Return the recording as the mapping makes it."""
    entries = remedy.partition(": ")[2].removesuffix(".").split("; ")
    content = yaml.safe_load("\n".join(entries))
    mapping = completed(mapping_from_config({"kind": good.kind, **content}), good.frame.columns)
    return recording_of(log_of_table(good.frame, Path("log.csv"), "table"), mapping).frame


def assert_mended(good: Recording, fault: Transformation) -> None:
    frame, undone = mapped(good, fault.remedy), fault.undo(samples_of(good))
    for column in fault.columns:
        np.testing.assert_allclose(frame[column], undone[column], rtol=1e-3, atol=1e-9, err_msg=fault.remedy)


@pytest.mark.parametrize(
    ("kind", "machine", "least"),
    [
        ("joint", None, 15),
        pytest.param("swerve", "swerve_robot", 25, marks=pytest.mark.slow),
        pytest.param("quadrotor", "racer", 25, marks=pytest.mark.slow),
    ],
)
def test_the_lines_that_are_given_mend_what_is_wrong(kind, machine, least):
    platform = SERVO
    if machine is not None:
        platform = platform_from_config({"kind": kind} | read_yaml(ROOT / f"conf/platform/{machine}.yaml"))
    good = recording(kind)
    faults = list(remedies(good, platform))
    for fault in faults:
        assert_mended(good, fault)
    assert len(faults) >= least


@pytest.mark.parametrize(("pulses", "cause"), [(False, "thrust_command"), (True, "pulse_width")])
def test_a_command_of_another_sort_has_such_lines(pulses, cause):
    good = recording("quadrotor", pulses)
    (fault,) = (each for each in remedies(good, None) if each.suspected == cause)
    assert_mended(good, fault)
