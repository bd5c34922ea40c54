"""Roll, pitch and yaw of a table get their quaternion beside them."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.spatial.transform import Rotation

from simgap.logs.tabular import log_of_table

YAW, PITCH, ROLL = np.array([20.0, -170.0, 3.0]), np.array([5.0, -60.0, 0.0]), np.array([-30.0, 100.0, 1.0])


def quaternion_of(**columns: np.ndarray) -> np.ndarray | None:
    """Return the quaternion that a table gets, (n, 4); None where it gets none."""
    signals = log_of_table(pd.DataFrame(columns), Path("log.csv"), "table").signals
    found = [signal.values for name, signal in signals.items() if name.startswith("quaternion of ")]
    return np.stack(found, axis=1) if found else None


@pytest.mark.parametrize("names", ["{}_deg", "imu_{}_deg", "{}", "Est.{} [deg]"])
def test_the_vehicle_is_turned_by_yaw_then_pitch_then_roll(names: str) -> None:
    angles = {names.format(name): each for name, each in (("roll", ROLL), ("pitch", PITCH), ("yaw", YAW))}
    found = quaternion_of(**angles)
    assert found is not None
    z, y, x = (
        Rotation.from_rotvec(np.deg2rad(each)[:, None] * axis)
        for axis, each in zip(np.eye(3)[::-1], (YAW, PITCH, ROLL), strict=True)
    )
    same = (Rotation.from_quat(found, scalar_first=True).inv() * (z * y * x)).magnitude()
    np.testing.assert_allclose(same, 0.0, atol=1e-12)


def test_small_angles_without_a_unit_are_in_radians() -> None:
    found = quaternion_of(Roll=np.array([0.1]), Pitch=np.zeros(1), Yaw=np.zeros(1))
    np.testing.assert_allclose(found, [[np.cos(0.05), np.sin(0.05), 0.0, 0.0]])


def test_a_missing_angle_leaves_the_quaternion_unknown() -> None:
    found = quaternion_of(
        roll_rad=np.array([0.1, np.nan, 0.0, 0.0]), pitch_rad=np.zeros(4), yaw_rad=np.zeros(4)
    )
    assert found is not None
    assert np.isfinite(found).all(axis=1).tolist() == [True, False, True, True]


@pytest.mark.parametrize("unit", ["rate_dps", "cmd", "pid_out"])
def test_rates_commands_and_outputs_are_no_angles(unit: str) -> None:
    assert quaternion_of(**{f"{name}_{unit}": ROLL for name in ("roll", "pitch", "yaw")}) is None


def test_two_of_three_angles_are_none() -> None:
    assert quaternion_of(roll_deg=ROLL, pitch_deg=PITCH) is None
