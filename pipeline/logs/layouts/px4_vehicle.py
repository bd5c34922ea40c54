"""What vehicle a log of PX4 is of."""

import numpy as np

from simgap.logs.layouts.choices import number
from simgap.logs.log import Log

_TYPES = {
    1: "fixed wing", 3: "coaxial helicopter", 4: "helicopter", 7: "airship", 10: "rover", 11: "boat",
    12: "submarine", 13: "hexarotor", 14: "octorotor", 15: "tricopter", 19: "VTOL", 20: "VTOL", 21: "VTOL",
    22: "VTOL", 23: "VTOL", 24: "VTOL", 25: "VTOL", 29: "dodecarotor",
}  # fmt: skip
"""MAV_TYPE of MAVLink that are no quadrotors."""
_AIRFRAMES = {1: "fixed wing", 2: "VTOL", 3: "VTOL", 4: "VTOL", 5: "rover", 6: "rover", 10: "helicopter"}
"""CA_AIRFRAME that are no multicopters."""


def not_a_quadrotor(log: Log) -> str:
    """Return why a log is not of a quadrotor; empty where it may be."""
    name = (
        _TYPES.get(int(number(log, "MAV_TYPE") or 0))
        or _AIRFRAMES.get(int(number(log, "CA_AIRFRAME") or 0))
        or ("VTOL" if _ever(log, "vehicle_status.is_vtol", 1.0) else None)
        or _TYPES.get(_last(log, "vehicle_status.system_type"))
        or {2: "fixed wing", 3: "rover"}.get(_last(log, "vehicle_status.vehicle_type"))
    )
    rotors = number(log, "CA_ROTOR_COUNT")
    if name is None and rotors and int(rotors) != 4:
        name = f"multicopter with {int(rotors)} rotors"
    if name is None:
        return ""
    airframe = f" (SYS_AUTOSTART {log.facts['SYS_AUTOSTART']})" if "SYS_AUTOSTART" in log.facts else ""
    return f"is a log of a {name}{airframe}, not of a quadrotor; only vehicles with four fixed rotors are modelled"


def _ever(log: Log, signal: str, value: float) -> bool:
    return signal in log.signals and bool(np.any(log.signals[signal].values == value))


def _last(log: Log, signal: str) -> int:
    values = log.signals[signal].values if signal in log.signals else np.empty(0)
    return int(values[-1]) if len(values) and np.isfinite(values[-1]) else 0
