"""An arm's motions: one joint of six, and the voltage of the servo's own law."""

import numpy as np
import pytest

from simgap.errors import InputError
from simgap.recordings.importers.arm_motion import read

OPTIONS = {"joint": 1, "supply": 10.0, "gain": 2.0}
STATE = """type,timestamp,positions,velocities,torques
STATE_MOTOR,0,"[9.0, 0.1]","[9.0, 0.5]","[9.0, 0.0]"
STATE_MOTOR,20000,"[9.0, 0.2]","[9.0, 0.6]","[9.0, 0.0]"
STATE_MOTOR,40000,"[9.0, 0.3]","[9.0, 0.7]","[9.0, 0.0]"
"""
CONTROL = """type,timestamp,positions
CONTROL,0,"[0.0, 0.1]"
CONTROL,20000,"[0.0, 0.3]"
CONTROL,40000,"[0.0, -9.0]"
"""


def _write(folder, state=STATE, control=CONTROL):
    folder.mkdir()
    paths = [folder / "control.csv", folder / "state_motor.csv"]
    for path, text in zip(paths, (control, state), strict=True):
        path.write_text(text)
    return paths


def test_a_joint_with_the_voltage_of_its_servo(tmp_path):
    recording = read([*_write(tmp_path / "a"), *_write(tmp_path / "b")], OPTIONS)
    assert recording.runs == ["a", "b"]
    run = recording.frame[recording.frame["run"] == "a"]
    np.testing.assert_allclose(run["t"], [0.0, 0.02, 0.04])
    np.testing.assert_allclose(run["position"], [0.1, 0.2, 0.3])
    np.testing.assert_allclose(run["velocity"], [0.5, 0.6, 0.7])
    np.testing.assert_allclose(
        run["voltage"], [0.0, 2.0, -9.7], atol=1e-12
    )  # the last at the firmware's limit
    assert "calculated by the servo's proportional law at 10 V" in recording.warnings[0]


@pytest.mark.parametrize(
    ("state", "control", "words"),
    [
        (STATE.replace("velocities", "rates"), CONTROL, r"state_motor\.csv: column 'velocities' is missing"),
        (STATE.replace('"[9.0, 0.2]"', '"[9.0]"'), CONTROL, "'positions' holds no number of joint 1"),
        (STATE, CONTROL.replace("20000", "20001"), r"control\.csv: its times are not those of the state"),
        (STATE, "".join(CONTROL.splitlines(True)[:-1]), "its times are not those of the state"),
    ],
)
def test_mistakes(tmp_path, state, control, words):
    with pytest.raises(InputError, match=words):
        read(_write(tmp_path / "a", state, control), OPTIONS)


def test_half_a_motion(tmp_path):
    with pytest.raises(InputError, match=r"'control\.csv' is missing"):
        read(_write(tmp_path / "a")[1:], OPTIONS)


@pytest.mark.parametrize("key", OPTIONS)
def test_options(tmp_path, key):
    with pytest.raises(InputError, match=f"dataset.options.{key}: None is not a number"):
        read(_write(tmp_path / "a"), {name: value for name, value in OPTIONS.items() if name != key})


def test_the_voltage_drives_the_real_joint(shared_data):
    """Slow turns need the back-EMF, 1.2 V/(rad/s) as published for the motor, and friction; neither is negative."""
    folder = shared_data / "arm_so101" / "single_joint_rotation"
    paths = [folder / "control.csv", folder / "state_motor.csv"]
    frame = read(paths, {"joint": 0, "supply": 7.4, "gain": 2.656}).frame
    turning = frame[frame["velocity"].abs() > 0.15]
    matrix = np.column_stack([turning["velocity"], np.sign(turning["velocity"])])
    slope, friction = np.linalg.lstsq(matrix, turning["voltage"], rcond=None)[0]
    assert 0.8 < slope / 1.178 < 1.6
    assert 0.05 < friction < 0.4
    assert np.corrcoef(turning["velocity"], turning["voltage"])[0, 1] > 0.95
