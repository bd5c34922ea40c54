import pytest
import torch
import yaml

from simgap.errors import InputError
from simgap.policies.profile.identified import identified_drive
from tests.pipeline.platforms.machines import SWERVE


def parameters(**changed):
    gains = {"kS": {"value": 0.4}, "kV": {"value": 0.014}, "kA": {"value": 0.0037}}
    return {f"drive_{n}": gains for n in range(1, 5)} | changed


def write(folder, content):
    path = folder / "parameters.yaml"
    path.write_text(yaml.safe_dump(content))
    return path


def test_motor_constants_become_constants_per_metre(tmp_path):
    drive = identified_drive(write(tmp_path, parameters()), SWERVE, 12.0, 9.0)
    turns = SWERVE.drive.gear_ratio / SWERVE.wheel_radius
    torch.testing.assert_close(drive.static, torch.full((4,), 0.4))
    torch.testing.assert_close(drive.speed, torch.full((4,), 0.014 * turns))
    torch.testing.assert_close(drive.acceleration, torch.full((4,), 0.0037 * turns))
    assert (drive.voltage_limit, drive.acceleration_limit) == (12.0, 9.0)


def test_an_identified_radius_counts_more_than_the_platforms(tmp_path):
    smaller = {"rolling_radius": {"value": 0.5 * SWERVE.wheel_radius}}
    drive = identified_drive(write(tmp_path, parameters(wheels=smaller)), SWERVE, 12.0)
    nominal = identified_drive(write(tmp_path, parameters()), SWERVE, 12.0)
    torch.testing.assert_close(drive.speed, 2.0 * nominal.speed)


@pytest.mark.parametrize("motor", [{}, {"kS": {"value": 0.4}, "kV": {"value": None}, "kA": {"value": 1.0}}])
def test_a_motor_that_is_not_known_is_refused(tmp_path, motor):
    with pytest.raises(InputError, match="of a drive motor is not known"):
        identified_drive(write(tmp_path, parameters(drive_3=motor)), SWERVE, 12.0)


def test_a_missing_file_is_refused_in_one_line(tmp_path):
    with pytest.raises(InputError, match="run simgap sysid"):
        identified_drive(tmp_path / "parameters.yaml", SWERVE, 12.0)
