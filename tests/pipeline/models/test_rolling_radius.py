import numpy as np
import pandas as pd
import pytest
import torch

from simgap.models.identify import identify
from simgap.models.rolling_radius import identify_rolling_radius
from simgap.models.settings import SystemIdentification
from simgap.platforms.swerve_kinematics import module_states
from tests.pipeline.models.synthetic import recording
from tests.pipeline.platforms.machines import SWERVE

RADIUS = 0.93 * SWERVE.wheel_radius


def drive(seed: int, samples: int = 2000, noise: float = 0.0, measured: bool = True):
    """Return a drive along curves, on wheels that are smaller than the platform says."""
    random = np.random.default_rng(seed)
    time = 0.01 * np.arange(samples)
    twist = np.stack([np.sin(time * rate + phase) for rate, phase in ((0.7, 0.0), (0.5, 1.0), (0.9, 2.0))], 1)
    positions = torch.tensor(SWERVE.module_positions, dtype=torch.float64)
    angle, speed = module_states(
        torch.from_numpy(twist), positions, torch.zeros(samples, 4, dtype=torch.float64)
    )
    turning = SWERVE.drive.gear_ratio / RADIUS * speed.numpy()
    columns = {f"drive_velocity_{n}": turning[:, n - 1] for n in range(1, 5)}
    columns |= {f"steer_angle_{n}": angle[:, n - 1].numpy() for n in range(1, 5)}
    columns |= {f"drive_voltage_{n}": 0.02 * turning[:, n - 1] for n in range(1, 5)}
    columns |= {f"steer_voltage_{n}": np.zeros(samples) for n in range(1, 5)}
    columns |= {f"steer_velocity_{n}": np.zeros(samples) for n in range(1, 5)}
    if measured:
        seen = twist + noise * random.standard_normal(twist.shape)
        columns |= dict(
            zip(("chassis_velocity_x", "chassis_velocity_y", "chassis_rate"), seen.T, strict=True)
        )
    return recording(pd.DataFrame({"run": "a", "t": time, "segment": 0} | columns), "swerve")


def test_the_radius_is_found_along_curves():
    found = identify_rolling_radius(drive(0), SWERVE, ["a"], SystemIdentification())
    assert found.value == pytest.approx(RADIUS, rel=1e-9)
    assert found.nominal == SWERVE.wheel_radius


def test_its_standard_error_covers_the_noise_of_the_chassis():
    found = [
        identify_rolling_radius(drive(seed, noise=0.2), SWERVE, ["a"], SystemIdentification())
        for seed in range(20)
    ]
    scatter = np.std([parameter.value for parameter in found], ddof=1)
    stated = np.mean([parameter.standard_error for parameter in found])
    assert 0.5 < stated / scatter < 2.0


def test_without_a_measured_chassis_there_is_no_radius():
    assert identify_rolling_radius(drive(0, measured=False), SWERVE, ["a"], SystemIdentification()) is None


def test_identification_lists_it_beside_the_motors():
    parameters = identify(drive(0), SWERVE, SystemIdentification()).parameters
    assert parameters["wheels"]["rolling_radius"].value == pytest.approx(RADIUS, rel=1e-6)
    assert "wheels" not in identify(drive(0, measured=False), SWERVE, SystemIdentification()).parameters
