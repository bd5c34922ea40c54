"""Counts and duty cycles of four wheels become angles, speeds and volts of four joints."""

import math

import numpy as np
import pytest

from simgap.errors import InputError
from simgap.recordings.importers.wheel_excitation import read

ROW = "10, 0, -10, 0, 256, 0, -512, 4, 360, -1540\n"


def test_units(tmp_path):
    path = tmp_path / "drive"
    path.write_text(ROW * 4)
    recording = read([path], {})
    assert recording.runs == [f"drive-wheel{wheel}" for wheel in range(1, 5)]
    first, _, third, fourth = (run for _, run in recording.frame.groupby("run"))
    np.testing.assert_allclose(first["t"], 0.005 * np.arange(1, 5))
    np.testing.assert_allclose(first["position"], 2 * math.pi / 6144 * np.array([10, 20, 30, 40]))
    np.testing.assert_allclose(third["velocity"], -2 * math.pi / 6144 * 10 / 0.005)
    np.testing.assert_allclose(first["voltage"], 9.5)
    np.testing.assert_allclose(third["voltage"], -19.0)
    np.testing.assert_allclose(fourth["voltage"], 4 / 512 * 19)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (ROW + "10, 0, -1\n" + ROW, r"row 2: is not 10 numbers"),
        (ROW + ROW.replace("360", "0") + ROW, r"row 2: is not 10 numbers with a positive time"),
        (ROW + ROW.replace("256", "x"), r"row 2: is not 10 numbers"),
        (ROW, "fewer than three rows"),
    ],
)
def test_mistakes(tmp_path, text, words):
    path = tmp_path / "drive"
    path.write_text(text)
    with pytest.raises(InputError, match=words):
        read([path], {})


def test_the_back_emf_is_that_of_the_motor(shared_data):
    """At constant speed V = kS·sign(v) + kV·v with the data sheet's kV = 7/2 · 30/(380·π) V/(rad/s)."""
    folder = shared_data / "omni_drive" / "robot2018" / "plant_excitation"
    frame = read([folder / "excite_1", folder / "excite_4_vely_4"], {}).frame
    acceleration = frame.groupby("run")["velocity"].transform(
        lambda v: np.gradient(v.rolling(21, center=True).mean())
    )
    steady = frame[(frame["velocity"].abs() > 10) & (acceleration.abs() < 0.05)]
    matrix = np.column_stack([steady["velocity"], np.sign(steady["velocity"])])
    slope, friction = np.linalg.lstsq(matrix, steady["voltage"], rcond=None)[0]
    assert slope == pytest.approx(3.5 * 30 / (380 * math.pi), rel=0.1)
    assert 0.05 < friction < 0.5
