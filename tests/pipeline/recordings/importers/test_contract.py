"""What every importer owes: the contract's columns, units and frames, on the recordings as published."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from simgap.consistency import contradictions
from simgap.consistency.attitude import turning_pairs
from simgap.consistency.kinematics import position_pairs
from simgap.consistency.redundancy import agreement_of
from simgap.consistency.samples import samples_of
from simgap.errors import InputError
from simgap.recordings import read_recording, write_recording
from simgap.recordings.contract import ANY_OF, INDEX_COLUMNS, REQUIRED, channel_units
from simgap.recordings.importers import IMPORTERS, importer

FLYWHEEL = {
    "kind": "joint",
    "columns": {
        "t": {"column": "Time (s)", "unit": "s"},
        "voltage": {"column": "Input voltage (V)", "unit": "V"},
        "velocity": {"column": "Angular velocity (rad/s)", "unit": "rad/s"},
    },
    "integrate": {"position": "velocity"},
}
ARM = {"joint": 0, "supply": 7.4, "gain": 2.656}
FLIGHTS = {"flights": {"log10": [[35, 65]], "log15": [[55, 90]], "log16": [[32, 38], [45, 49]]}}
CASES = {
    "nanodrone": ("nanodrone", "nanodrone/raw_parquet/square_*_run[35].parquet", {}),
    "nanobench": ("nanobench", "nanobench/B[78]*.csv", {}),
    "swerve_drive": ("sysid_json", "swerve_drive/data.json", {"position": "units", "velocity": "units"}),
    "swerve_drive_sim": (
        "sysid_json",
        "swerve_drive_sim/data.json",
        {"position": "units", "velocity": "rotations"},
    ),
    "flywheel": ("table", "flywheel/*.csv", FLYWHEEL),
    "servo_xl330": ("pendulum_json", "servo_xl330/raw/*.json", {}),
    "arm_so101": ("arm_motion", "arm_so101/*/[cs][ot]*.csv", ARM),
    "crazyflie_thrust_lag": ("crazyflie_log", "crazyflie_thrust_lag/log1*", FLIGHTS),
    "omni_drive": ("wheel_excitation", "omni_drive/robot2018/plant_excitation/*", {}),
}


@pytest.fixture(scope="module", params=CASES)
def imported(request, shared_data):
    """The recording that an importer makes of published files."""
    name, pattern, options = CASES[request.param]
    return IMPORTERS[name](sorted(shared_data.glob(pattern)), options)


def test_every_importer_is_tried():
    assert {name for name, _, _ in CASES.values()} == set(IMPORTERS)


def test_columns_and_units(imported):
    columns = set(imported.frame.columns)
    units = channel_units(
        imported.kind, sliding=imported.units.get("position") == "m" and imported.kind == "joint"
    )
    assert set(REQUIRED[imported.kind]) <= columns
    assert not ANY_OF[imported.kind] or any(set(group) <= columns for group in ANY_OF[imported.kind])
    assert columns <= set(units) | set(INDEX_COLUMNS)
    assert imported.units == {column: units[column] for column in imported.frame if column in units}


def test_types_and_time(imported):
    frame = imported.frame
    assert all(frame[column].dtype == np.float64 for column in frame.columns if column != "run")
    steps = frame.groupby("run", sort=False)["t"].diff().dropna()
    assert (steps > 0).all()
    assert 5e-4 < steps.median() < 0.1  # recorded at 10 Hz to 1 kHz, in seconds


def test_rates_are_those_of_what_they_are_the_rate_of(imported):
    """Within noise and lag; the wrong unit, sign or frame is off by far more."""
    samples = samples_of(imported)
    pairs = [
        *position_pairs(samples),
        *(list(turning_pairs(samples))[:2] if imported.kind == "quadrotor" else []),
    ]
    found = [agreement for pair in pairs if (agreement := agreement_of(pair)) is not None]
    assert found
    for agreement in found:
        assert not agreement.clear
        assert agreement.alike > 0.75
        assert agreement.ratio == pytest.approx(1.0, abs=0.25)


def test_nothing_contradicts_itself(imported):
    assert contradictions(imported) == []


def test_only_what_is_true_is_doubted(imported):
    allowed = (
        "was integrated from",
        "only one run",
        "the voltage is not known there",
        "The supply was not recorded",
        "No voltage was recorded",
        "they are dead-reckoned",
    )
    assert all(any(words in warning for words in allowed) for warning in imported.warnings)


def test_what_is_imported_can_be_written_and_read(imported, tmp_path):
    write_recording(imported, tmp_path / "a.parquet")
    again = read_recording(tmp_path / "a.parquet")
    pd.testing.assert_frame_equal(again.frame, imported.frame)
    assert again.warnings == imported.warnings


@pytest.mark.parametrize("name", IMPORTERS)
def test_another_file_or_option_is_refused(name, tmp_path):
    path = tmp_path / "other.csv"
    path.write_text("a,b\n1,2\n")
    options = {"table": FLYWHEEL, "arm_motion": ARM}.get(name, {})
    with pytest.raises(InputError, match=r"other\.csv"):
        importer(name)([Path(path)], options)
    with pytest.raises(InputError, match=f"the importer '{name}' has no option 'colour'"):
        importer(name)([Path(path)], {"colour": "red"})
