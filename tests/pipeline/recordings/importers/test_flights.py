"""The published flights obey physics in the contract's units and frames."""

import numpy as np
import pytest

from simgap.recordings.importers import nanobench, nanodrone

GRAVITY = 9.81


def _flying(recording):
    """The samples with all rotors well above idle."""
    frame = recording.frame
    name = "motor_speed" if "motor_speed_1" in frame else "motor_command"
    motors = frame[[f"{name}_{rotor}" for rotor in "1234"]]
    return frame[(motors > 0.5 * motors.median()).all(axis=1) & (frame["position_z"] > 0.3)].dropna()


@pytest.fixture(scope="module")
def brushless(shared_data):
    return _flying(nanodrone.read(sorted(shared_data.glob("nanodrone/raw_parquet/melon_*_run1.parquet")), {}))


@pytest.fixture(scope="module")
def brushed(shared_data):
    return _flying(nanobench.read(sorted(shared_data.glob("nanobench/B[78]*.csv")), {}))


def test_the_rotors_carry_the_weight(brushless):
    """Published: 3.72e-8 N/(rad/s)² and 45 g; thrust is what an accelerometer along z reads."""
    speeds = brushless[[f"motor_speed_{rotor}" for rotor in "1234"]].to_numpy()
    thrust = 3.72e-8 * (speeds**2).sum(axis=1) / 0.045
    slope = np.polyfit(thrust, brushless["specific_force_z"], 1)[0]
    assert np.corrcoef(thrust, brushless["specific_force_z"])[0, 1] > 0.95
    assert slope == pytest.approx(1.0, abs=0.08)
    assert thrust.mean() == pytest.approx(GRAVITY, rel=0.1)


@pytest.mark.parametrize("flight", ["brushless", "brushed"])
def test_the_specific_force_is_in_the_body_frame_in_si(flight, request):
    frame = request.getfixturevalue(flight)
    force = frame[[f"specific_force_{axis}" for axis in "xyz"]]
    assert force["specific_force_z"].median() == pytest.approx(GRAVITY, rel=0.05)
    # a rotor craft is pushed along its own z: what is left across is drag, some tenths of a m/s²
    assert force[["specific_force_x", "specific_force_y"]].std().max() < 1.0


@pytest.mark.parametrize("flight", ["brushless", "brushed"])
@pytest.mark.parametrize("axis", ["x", "y"])
def test_drag_opposes_motion_in_the_body_frame(flight, axis, request):
    """About −0.4 1/s in both: only if attitude, velocity and force are in the frames they claim."""
    frame = request.getfixturevalue(flight)
    w, x, y, z = (frame[f"attitude_{name}"].to_numpy() for name in "wxyz")
    velocity = frame[[f"velocity_{name}" for name in "xyz"]].to_numpy()
    rows = {
        "x": (1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)),
        "y": (2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)),
    }
    along_body = sum(column * velocity[:, index] for index, column in enumerate(rows[axis]))
    slope = np.polyfit(along_body, frame[f"specific_force_{axis}"], 1)[0]
    assert -0.52 < slope < -0.34


@pytest.mark.parametrize("flight", ["brushless", "brushed"])
def test_acceleration_is_specific_force_less_gravity(flight, request):
    """Rotate the force into the world, and compare with the change of velocity."""
    frame = request.getfixturevalue(flight)
    w, x, y, z = (frame[f"attitude_{name}"].to_numpy() for name in "wxyz")
    force = frame[[f"specific_force_{name}" for name in "xyz"]].to_numpy()
    upward = np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], axis=1)
    climb = (upward * force).sum(axis=1) - GRAVITY
    window = 10
    velocity, time = frame["velocity_z"].to_numpy(), frame["t"].to_numpy()
    measured = (velocity[window:] - velocity[:-window]) / (time[window:] - time[:-window])
    mean = np.convolve(climb, np.full(window + 1, 1 / (window + 1)), mode="valid")
    unbroken = np.abs(time[window:] - time[:-window] - 0.01 * window) < 0.015
    assert np.corrcoef(mean[unbroken], measured[unbroken])[0, 1] > 0.9


def test_motor_channels(brushless, brushed):
    commands = [f"motor_command_{rotor}" for rotor in "1234"]
    for frame in (brushless, brushed):
        assert frame[commands].to_numpy().min() >= 0
        assert frame[commands].to_numpy().max() <= 1
        assert frame["battery_voltage"].between(2.5, 4.3).all()
    speed = brushless["motor_speed_1"]
    assert 1300 < speed.median() < 2200  # 1722 rad/s carries a quarter of the weight
    assert np.corrcoef(speed, brushless["motor_command_1"])[0, 1] > 0.7


def test_the_estimate_is_near_the_truth(brushed):
    for axis in "xyz":
        error = brushed[f"estimate_position_{axis}"] - brushed[f"position_{axis}"]
        assert error.abs().median() < 0.05
    columns = [f"attitude_{axis}" for axis in "wxyz"]
    estimate = brushed[[f"estimate_{column}" for column in columns]].to_numpy()
    same = np.abs((estimate * brushed[columns].to_numpy()).sum(axis=1))
    assert np.median(2 * np.arccos(np.clip(same, 0, 1))) < 0.06


def test_time_starts_at_zero(shared_data):
    recording = nanobench.read(sorted(shared_data.glob("nanobench/B7*.csv")), {})
    assert recording.frame["t"].iloc[0] == 0.0
