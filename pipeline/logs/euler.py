"""Angles of roll, pitch and yaw as a quaternion, since the contract has no angles."""

import numpy as np

from simgap.logs.log import Signal
from simgap.recordings.units import conversion

_ANGLES = ("yaw", "pitch", "roll")  # in the order in which a vehicle is turned (aerospace, ZYX)
_LARGEST = 2.2 * np.pi  # rad; angles without a unit that are larger are in degrees


def add_quaternions(signals: dict[str, Signal]) -> None:
    """Add the quaternion, scalar first, of every three signals that differ in the words roll, pitch and yaw only.

    The frame stays that of the angles: of a vehicle whose z points down if theirs does.

    Args:
        signals: of a table, by name; signals in other units than those of angles are left alone.
    """
    for name in list(signals):
        if "roll" not in name.lower() or not _is_angle(signals[name]):
            continue
        names = [_with(name, angle) for angle in _ANGLES]
        parts = [signals.get(each) for each in names]
        if any(part is None or not _is_angle(part) for part in parts):
            continue
        known = [part for part in parts if part is not None]
        if len({len(part.time) for part in known}) == 1:
            signals |= _quaternion(known)


def _is_angle(signal: Signal) -> bool:
    """Whether a signal is in a unit of angles, or is named after nothing else."""
    found = conversion(signal.unit) if signal.unit else None
    return found[0] == "rad" if found else signal.name.lower() in _ANGLES


def _with(name: str, angle: str) -> str:
    """Return a name with another angle in place of roll, written as that is."""
    place = name.lower().index("roll")
    written = name[place : place + 4]
    other = angle.upper() if written.isupper() else angle.title() if written[0].isupper() else angle
    return name[:place] + other + name[place + 4 :]


def _quaternion(parts: list[Signal]) -> dict[str, Signal]:
    from scipy.spatial.transform import Rotation  # few logs have angles, and a refusal does not wait for it

    angles = np.stack([part.values for part in parts], axis=1)
    found = conversion(parts[0].unit) if parts[0].unit else None
    degrees = np.nanmax(np.abs(angles), initial=0.0) > _LARGEST
    factor = found[1] if found else np.pi / 180 if degrees else 1.0
    values = np.full((len(angles), 4), np.nan)
    whole = np.isfinite(angles).all(axis=1)
    if whole.any():
        values[whole] = Rotation.from_euler("ZYX", factor * angles[whole]).as_quat(scalar_first=True)
    title = f"quaternion of {', '.join(part.name for part in reversed(parts))}"
    named = {f"{title}: {axis}": values[:, place] for place, axis in enumerate("wxyz")}
    return {name: Signal(name, parts[0].time, np.ascontiguousarray(each)) for name, each in named.items()}
