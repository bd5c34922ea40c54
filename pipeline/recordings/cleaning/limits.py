"""Values outside the physical limits of a channel."""

import numpy as np

from simgap.recordings.cleaning.channels import MOTOR_COMMAND, MOTOR_SPEED
from simgap.recordings.cleaning.work import RunUnderCleaning

_COMMAND_ROUNDING = 1e-3  # a command logged as 1.0005 is a full command
_BOUNDS = dict.fromkeys(MOTOR_COMMAND, (0.0, 1.0)) | dict.fromkeys(MOTOR_SPEED, (0.0, np.inf))
_BOUNDS["battery_voltage"] = (0.0, np.inf)


def erase_beyond_limits(run: RunUnderCleaning) -> None:
    """Erase values outside the bounds of their channel: commands in 0 to 1, speeds and voltage not
    negative."""
    for column, (low, high) in _BOUNDS.items():
        if column in run.columns:
            values = run.column(column)
            with np.errstate(invalid="ignore"):
                beyond = (values < low - _COMMAND_ROUNDING) | (values > high + _COMMAND_ROUNDING)
            if beyond.any():
                extreme = values[beyond][np.argmax(np.abs(values[beyond]))]
                run.erase(beyond, [column], "limits", f"outside {low:g} to {high:g}", f"up to {extreme:.4g}")
