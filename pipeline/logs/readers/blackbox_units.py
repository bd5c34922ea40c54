"""Scales and units of the fields of a blackbox log, by the header of the log.

Source: betaflight.com/docs/development/Blackbox-Internals (gyro_scale, acc_1G, vbatref).
"""

import math
import re

from simgap.logs.readers.blackbox_header import Header

_IN_HUNDREDTHS = {"Betaflight": 4.0, "INAV": 2.0}
"""Version from which a firmware logs voltages in 0.01 V; before, the scale is that of its own analogue input."""
_FINE = 10.0  # times finer is what Betaflight logs with blackbox_high_resolution
_PER_MICROSECOND = 1e-3  # a gyro scale below is in rad/µs (Cleanflight), above in deg/s
_ERPM = 100.0  # electrical turns per minute of one step


def scale_of(name: str, header: Header) -> tuple[float, str | None]:
    """Return what a step of a field is, and in which unit; None where the firmware's own number is left as it is.

    Args:
        name: of the field.
        header: of its log.
    """
    stem = re.sub(r"\[\d+\]$", "", name)
    fine = _FINE if header.number("blackbox_high_resolution", 0.0) > 0 else 1.0
    if stem in ("gyroADC", "gyroUnfilt"):
        return _gyro(header.gyro_scale, fine)
    if stem == "accSmooth" and header.number("acc_1G", 0.0) > 0:
        return 1.0 / header.number("acc_1G", 1.0), "g"
    if stem == "axisRate" or (stem == "setpoint" and name != "setpoint[3]"):
        return 1.0 / fine, "deg/s"
    name_of, version = header.firmware
    if stem in ("vbatLatest", "vbat") and version >= _IN_HUNDREDTHS.get(name_of, math.inf):
        return 0.01, "V"
    if stem in ("amperageLatest", "amperage") and version >= _IN_HUNDREDTHS.get(name_of, math.inf):
        return 0.01, "A"
    return (_ERPM, None) if stem == "eRPM" else (1.0, None)


def _gyro(scale: float | None, fine: float) -> tuple[float, str | None]:
    if scale is None or not 0.0 < scale < math.inf:
        return 1.0, None
    if scale < _PER_MICROSECOND:
        return scale * 1e6, "rad/s"
    return scale / fine, "deg/s"
