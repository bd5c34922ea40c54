"""Velocity of an odometry in the frame of its pose; the message has it in the frame of the body."""

from collections.abc import Iterator, Mapping

import numpy as np

from simgap.logs.log import Signal

TYPE = "nav_msgs/msg/Odometry"
"""Of the messages."""


def world_velocity(topic: str, signals: Mapping[str, Signal]) -> Iterator[Signal]:
    """Yield the velocity of an odometry along x, y, z of the frame of its pose, m/s, as `topic/velocity_world/x`.

    The definition of nav_msgs/Odometry gives the twist in the frame of the child, the body. No row of a mapping can
    turn it.

    Args:
        topic: name of the odometry.
        signals: of it, by name.
    """
    body = [signals.get(f"{topic}/twist/twist/linear/{axis}") for axis in "xyz"]
    turn = [signals.get(f"{topic}/pose/pose/orientation/{axis}") for axis in "wxyz"]
    found = [signal for signal in (*body, *turn) if signal is not None]
    if len(found) < 7:
        return
    velocity = np.stack([signal.values for signal in found[:3]])
    w, *vector = (signal.values for signal in found[3:])
    for axis, values in zip("xyz", _turned(w, np.stack(vector), velocity), strict=True):
        yield Signal(f"{topic}/velocity_world/{axis}", found[0].time, values, "m/s")


def _turned(w: np.ndarray, vector: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """Return velocities (3, n) turned by quaternions of any length but 0: v + 2 w (q × v) + 2 q × (q × v)."""
    with np.errstate(all="ignore"):
        norm = np.sqrt(w**2 + (vector**2).sum(axis=0))
        w, vector = w / norm, vector / norm
        once = 2.0 * np.cross(vector, velocity, axis=0)
        return np.asarray(velocity + w * once + np.cross(vector, once, axis=0))
