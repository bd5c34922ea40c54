"""Rolling radius of a swerve drive's wheels, from the speeds of chassis and motors.

Worn or compressed tyres differ from the nominal radius, and dead reckoning from wheel turns has the same relative
error. Measured chassis speeds are projected on the directions of the wheels. Slip from driving and braking averages
out.
"""

from collections.abc import Sequence

import numpy as np
import torch

from simgap.models.parameters import Parameter
from simgap.models.regression import fit_table, is_determined, jackknife_error, join
from simgap.models.segments import segments
from simgap.models.settings import SystemIdentification
from simgap.platforms import Swerve
from simgap.platforms.swerve_kinematics import rolling_speed
from simgap.recordings.recording import Recording

_TWIST = ("chassis_velocity_x", "chassis_velocity_y", "chassis_rate")


def identify_rolling_radius(
    recording: Recording, platform: Swerve, runs: Sequence[str], settings: SystemIdentification
) -> Parameter | None:
    """Return the radius of all wheels together, m; None where the chassis was not measured, or stood.

    Args:
        recording: cleaned.
        platform: of which the ratio and the modules' positions are used.
        runs: to learn from.
        settings: of the identification.
    """
    if not set(_TWIST) <= set(recording.units):
        return None
    pieces, first = [], 0
    length = max(round(settings.block_duration / recording.time_step), 1)
    for segment in segments(recording, runs):
        turning = segment.columns(_four("drive_velocity")) / platform.drive.gear_ratio
        twist, angle = (torch.from_numpy(segment.columns(names)) for names in (_TWIST, _four("steer_angle")))
        rolling = rolling_speed(
            twist, angle, torch.tensor(platform.module_positions, dtype=torch.float64)
        ).numpy()
        block = first + np.repeat(np.arange(len(turning)) // length, turning.shape[1])
        pieces.append((turning.reshape(-1, 1), rolling.ravel(), block))
        first = int(block[-1]) + 1
    table = join(pieces)
    if not is_determined(table.regressors):
        return None
    fit = fit_table(table)
    error = float(jackknife_error(fit.left_out)[0])
    return Parameter(float(fit.coefficients[0]), "m", error, platform.wheel_radius)


def _four(name: str) -> list[str]:
    return [f"{name}_{number}" for number in range(1, 5)]
