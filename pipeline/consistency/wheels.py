"""The wheels of a swerve drive against each other and against the motion of the chassis."""

from collections.abc import Iterator

import numpy as np

from simgap.consistency.redundancy import OPPOSED, Pair
from simgap.consistency.samples import Samples
from simgap.platforms.swerve import Swerve

_LEAST_SPEED = 0.05  # m/s: tyres creep
_DOUBTED = 0.05  # wheels of one robot turn alike, its frame turns little: what is exchanged differs little
_LEAST_TURNING = 0.1  # rad/s


def wheel_pairs(samples: Samples, swerve: Swerve) -> Iterator[Pair]:
    """Yield each wheel's speed against that of the other three, and the chassis's twist against all four.

    Kinematics of a rigid body with wheels that roll without slip: v + ω × r, along each wheel's direction (Campion,
    Bastin & d'Andréa-Novel 1996).
    """
    angle = samples.mean_angle("steer_angle", "1234")
    rolling = samples.mean(samples.stack("drive_velocity", "1234"))
    rolling = rolling * swerve.wheel_radius / swerve.drive.gear_ratio
    direction = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    velocities = rolling[..., None] * direction  # (windows, modules, 2)
    for module in range(4):
        others = [each for each in range(4) if each != module]
        twist = _twist(velocities, swerve, others)
        expected = (_carried(twist, swerve.module_positions[module]) * direction[:, module]).sum(axis=-1)
        name = f"'drive_velocity_{module + 1}' against the other three wheels"
        columns = (f"drive_velocity_{module + 1}", "steer_angle", "drive_velocity")
        yield Pair(name, columns, rolling[:, module], expected, _LEAST_SPEED, _DOUBTED)
    twist = _twist(velocities, swerve, list(range(4)))
    names = {
        "chassis_velocity_x": (_LEAST_SPEED, _DOUBTED),
        "chassis_velocity_y": (_LEAST_SPEED, _DOUBTED),
        "chassis_rate": (_LEAST_TURNING, OPPOSED),
    }
    for place, (column, noise) in enumerate(names.items()):
        if column in samples:
            name, columns = f"{column!r} against the wheels", (column, "drive_velocity", "steer_angle")
            yield Pair(name, columns, samples.mean(samples[column]), twist[:, place], *noise)


def _twist(velocities: np.ndarray, swerve: Swerve, modules: list[int]) -> np.ndarray:
    """Return the twist of a chassis that fits some modules best, (windows, 3)."""
    rows = []
    for module in modules:
        x, y = swerve.module_positions[module]
        rows += [[1.0, 0.0, -y], [0.0, 1.0, x]]
    inverse = np.linalg.pinv(np.array(rows))
    return velocities[:, modules].reshape(len(velocities), 2 * len(modules)) @ inverse.T


def _carried(twist: np.ndarray, position: tuple[float, float]) -> np.ndarray:
    """Return the velocity of a module, (windows, 2) m/s."""
    x, y = position
    return np.stack([twist[:, 0] - twist[:, 2] * y, twist[:, 1] + twist[:, 2] * x], axis=-1)
