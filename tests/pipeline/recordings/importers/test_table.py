"""Tables by a map of columns: units, factors, codes for missing values."""

import numpy as np
import pytest

from simgap.errors import InputError
from simgap.recordings.importers.table import read

COLUMNS = {"t": "time", "position": "angle", "velocity": "speed", "voltage": "u"}


@pytest.fixture
def log(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("trial,time,angle,speed,u\na,0,0,60,1\na,10,90,-60,65535\nb,0,180,120,3\nb,20,90,0,4\n")
    return path


def _read(path, run_column="trial", **columns):
    return read([path], {"kind": "joint", "columns": COLUMNS | columns, "run_column": run_column})


def test_units_factors_and_codes(log):
    recording = _read(
        log,
        t={"column": "time", "unit": "ms"},
        position={"column": "angle", "unit": "deg", "scale": -1, "offset": 180},
        velocity={"column": "speed", "unit": "rpm"},
        voltage={"column": "u", "unit": "V", "missing": 65535, "scale": 2},
    )
    assert recording.runs == ["a", "b"]
    np.testing.assert_allclose(recording.frame["t"], [0, 0.01, 0, 0.02])
    np.testing.assert_allclose(recording.frame["position"], np.pi * np.array([1, 0.5, 0, 0.5]))
    np.testing.assert_allclose(recording.frame["velocity"], 2 * np.pi * np.array([1, -1, 2, 0]))
    np.testing.assert_allclose(recording.frame["voltage"], [2, np.nan, 6, 8])


def test_a_length_makes_the_joint_slide(log):
    recording = _read(
        log, position={"column": "angle", "unit": "mm"}, velocity={"column": "speed", "unit": "mm/s"}
    )
    assert recording.units == {"position": "m", "velocity": "m/s", "voltage": "V"}


def test_what_was_not_recorded_is_integrated_and_said(log):
    columns = {"t": "time", "velocity": "speed", "voltage": "u"}
    options = {
        "kind": "joint",
        "columns": columns,
        "run_column": "trial",
        "integrate": {"position": "velocity"},
    }
    recording = read([log], options)
    np.testing.assert_allclose(recording.frame["position"], [0, 0, 0, 1200])
    assert "Channel 'position' was integrated from 'velocity', from zero." in recording.warnings


@pytest.mark.parametrize(
    ("columns", "words"),
    [
        ({"position": "angel"}, "column 'angel' is missing"),
        ({"postion": "angle"}, r"unknown channel 'postion' for a joint; did you mean 'position'\?"),
        ({"position": {"column": "angle", "unit": "furlong"}}, "unknown unit 'furlong'"),
        ({"position": {"column": "angle", "unit": "V"}}, "unit 'V' does not fit"),
        ({"position": {"column": "angle", "scale": "two"}}, "'two' is not a number"),
        ({"position": {"unit": "deg"}}, "names no column"),
        ({"position": {"column": "angle", "factor": 2}}, "unknown key 'factor'"),
    ],
)
def test_mistakes_in_the_map(log, columns, words):
    with pytest.raises(InputError, match=words):
        _read(log, **columns)


def test_mistakes_beside_the_map(log):
    with pytest.raises(InputError, match="column 'flight' is missing"):
        _read(log, run_column="flight")
    with pytest.raises(InputError, match="'boat' is no kind"):
        read([log], {"kind": "boat", "columns": COLUMNS})
    with pytest.raises(InputError, match="no column of time"):
        read([log], {"kind": "joint", "columns": {"position": "angle"}})
    with pytest.raises(InputError, match="no channel 'torque' to integrate"):
        read([log], {"kind": "joint", "columns": COLUMNS, "integrate": {"position": "torque"}})
