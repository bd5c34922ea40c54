"""Gyroscope and accelerometer integrate to the motion that made them, and to what motion capture saw."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from simgap.recordings.cleaning import clean_recording
from simgap.recordings.dead_reckoning import dead_reckoning
from simgap.recordings.importers import nanobench

GRAVITY = 9.81


def _flight(duration=6.0, step=0.001):
    """A flight that tilts and sways, exactly: attitude, world velocity and what the sensors read."""
    time = np.arange(0.0, duration, step)
    angles = np.column_stack([0.3 * np.sin(4 * np.pi * time), 0.2 * np.cos(6 * np.pi * time), 0.1 * time])
    attitude = Rotation.from_euler("xyz", angles)
    rates = np.gradient(angles, time, axis=0)
    roll, pitch = angles[:, 0], angles[:, 1]
    body_rate = np.column_stack(
        [
            rates[:, 0] - rates[:, 2] * np.sin(pitch),
            rates[:, 1] * np.cos(roll) + rates[:, 2] * np.cos(pitch) * np.sin(roll),
            -rates[:, 1] * np.sin(roll) + rates[:, 2] * np.cos(pitch) * np.cos(roll),
        ]
    )
    omega = 2 * np.pi * np.array([1.0, 1.5, 0.5])
    velocity = 0.5 * np.sin(omega * time[:, None])
    acceleration = 0.5 * omega * np.cos(omega * time[:, None])
    force = attitude.inv().apply(acceleration + np.array([0.0, 0.0, GRAVITY]))
    return time, attitude, velocity, body_rate, force


def test_the_motion_that_made_the_readings_comes_back():
    time, attitude, velocity, body_rate, force = _flight()
    found, speed, _ = dead_reckoning(time, body_rate, force, GRAVITY)
    up = Rotation.from_quat(found, scalar_first=True).inv().apply([0.0, 0.0, 1.0])
    tilt = np.arccos(np.clip((up * attitude.inv().apply([0.0, 0.0, 1.0])).sum(axis=1), -1, 1))
    assert np.degrees(tilt).max() < 1.0
    heading = Rotation.from_euler("z", -attitude.as_euler("xyz")[0, 2])
    for axis in range(3):
        assert np.corrcoef(heading.apply(velocity)[:, axis], speed[:, axis])[0, 1] > 0.95


def test_a_tilted_start_is_turned_upright():
    time, _, _, body_rate, force = _flight()
    straight = dead_reckoning(time, body_rate, force, GRAVITY)[0]
    mounted = Rotation.from_euler("z", 0.5)
    turned = dead_reckoning(time, mounted.apply(body_rate), mounted.apply(force), GRAVITY)[0]
    up = [
        Rotation.from_quat(quaternion, scalar_first=True).inv().apply([0.0, 0.0, 1.0])
        for quaternion in (straight, turned)
    ]
    np.testing.assert_allclose(mounted.apply(up[0]), up[1], atol=1e-6)


@pytest.mark.parametrize("flight", ["B3_figure8_fast_rep2", "B5_helix_fast_rep3"])
def test_it_agrees_with_motion_capture(shared_data, flight):
    """Half a minute of a real flight: the tilt to 5°, the horizontal velocity to a third of itself."""
    recording = clean_recording(nanobench.read([shared_data / "nanobench" / f"{flight}.csv"], {}))[0]
    frame = recording.frame
    frame = frame[frame["segment"] == frame.groupby("segment").size().idxmax()]
    columns = {
        name: frame[[f"{name}_{axis}" for axis in axes]].to_numpy()
        for name, axes in {
            "attitude": "wxyz",
            "velocity": "xyz",
            "body_rate": "xyz",
            "specific_force": "xyz",
        }.items()
    }
    seen = Rotation.from_quat(columns["attitude"], scalar_first=True)
    found, velocity, _ = dead_reckoning(
        frame["t"].to_numpy(), columns["body_rate"], columns["specific_force"], GRAVITY
    )
    reckoned = Rotation.from_quat(found, scalar_first=True)
    up = (reckoned.inv().apply([0.0, 0.0, 1.0]) * seen.inv().apply([0.0, 0.0, 1.0])).sum(axis=1)
    assert np.degrees(np.median(np.arccos(np.clip(up, -1, 1)))) < 5.0
    error = reckoned.inv().apply(velocity) - seen.inv().apply(columns["velocity"])
    along = seen.inv().apply(columns["velocity"])
    assert (error[:, :2].std(axis=0) < 0.4 * along[:, :2].std(axis=0)).all()
