"""Kinematics of a swerve drive, forward and inverse, with the shortest rotation of a module.

Robot frame x forward, y left. A twist is [x m/s, y m/s, yaw rad/s].
"""

import math

import torch
from jaxtyping import Float
from torch import Tensor

from simgap.physics.shapes import Pair, Real, Vector

Positions = Float[Tensor, "modules 2"]
Velocities = Float[Tensor, "*#batch modules 2"]
Angles = Float[Tensor, "*#batch modules"]


def module_matrix(positions: Positions) -> Float[Tensor, "2*modules 3"]:
    """Return the matrix from a chassis twist to the velocities of all modules, (2·modules, 3).

    Rows come in pairs, x and y of each module: v = v_chassis + yaw × position.
    Source: Campion, Bastin & d'Andréa-Novel 1996, Structural properties and classification of kinematic and dynamic
    models of wheeled mobile robots (IEEE Trans. Robotics and Automation 12).

    Args:
        positions: of the modules, (modules, 2) m.
    """
    one, zero = torch.ones_like(positions[:, 0]), torch.zeros_like(positions[:, 0])
    along_x = torch.stack([one, zero, -positions[:, 1]], dim=-1)
    along_y = torch.stack([zero, one, positions[:, 0]], dim=-1)
    return torch.stack([along_x, along_y], dim=1).flatten(0, 1)


def module_velocities(twist: Vector, positions: Positions) -> Velocities:
    """Inverse kinematics: the velocity of each module, (..., modules, 2) m/s.

    Args:
        twist: of the chassis, (..., 3).
        positions: of the modules, (modules, 2) m.
    """
    x, y = positions.to(twist).unbind(-1)
    around = torch.stack([-y, x], dim=-1)
    return twist[..., None, :2] + twist[..., 2:, None] * around


def chassis_twist(velocities: Velocities, positions: Positions) -> Vector:
    """Forward kinematics: the twist that fits the modules' velocities best in the least-squares sense, (..., 3).

    Args:
        velocities: of the modules, (..., modules, 2) m/s.
        positions: of the modules, (modules, 2) m; not all in one place.
    """
    inverse = torch.linalg.pinv(module_matrix(positions.to(velocities)))
    return velocities.flatten(-2) @ inverse.T


def wheel_direction(angle: Real) -> Pair:
    """Return the unit vector that a wheel rolls along, (..., 2); an angle of zero points forward."""
    return torch.stack([torch.cos(angle), torch.sin(angle)], dim=-1)


def lateral_direction(angle: Real) -> Pair:
    """Return the unit vector across each wheel, to its left, (..., 2)."""
    return torch.stack([-torch.sin(angle), torch.cos(angle)], dim=-1)


def rolling_speed(twist: Vector, angle: Angles, positions: Positions) -> Angles:
    """Return how fast each wheel rolls along its direction, (..., modules) m/s.

    Args:
        twist: of the chassis, (..., 3).
        angle: of the modules, (..., modules) rad.
        positions: of the modules, (modules, 2) m.
    """
    return (module_velocities(twist, positions) * wheel_direction(angle)).sum(-1)


def lateral_matrix(angle: Angles, positions: Positions) -> Float[Tensor, "*#batch modules 3"]:
    """Return the matrix from a twist to each module's velocity across its wheel, (..., modules, 3).

    Args:
        angle: of the modules, (..., modules) rad.
        positions: of the modules, (modules, 2) m.
    """
    sine, cosine = torch.sin(angle), torch.cos(angle)
    x, y = positions.to(angle).unbind(-1)
    return torch.stack([-sine, cosine, cosine * x + sine * y], dim=-1)


def lateral_matrix_rate(
    angle: Angles, turning: Angles, positions: Positions
) -> Float[Tensor, "*#batch modules 3"]:
    """Return the rate of `lateral_matrix` while the modules turn, (..., modules, 3) per second.

    Args:
        angle: of the modules, (..., modules) rad.
        turning: rate of the angle, (..., modules) rad/s.
        positions: of the modules, (modules, 2) m.
    """
    sine, cosine = torch.sin(angle), torch.cos(angle)
    x, y = positions.to(angle).unbind(-1)
    return turning[..., None] * torch.stack([-cosine, -sine, cosine * y - sine * x], dim=-1)


def module_states(twist: Vector, positions: Positions, angle: Angles) -> tuple[Angles, Angles]:
    """Return the angles (rad) and speeds (m/s) that give a twist with the shortest turn from the present angles.

    A module never turns by more than a quarter turn. Beyond it, the module turns the other way and its wheel rolls
    backward. A module at rest keeps its angle.

    Args:
        twist: wanted, (..., 3).
        positions: of the modules, (modules, 2) m.
        angle: now, (..., modules) rad, on any turn.

    Returns:
        Angles on the turn nearest to the present ones, and speeds; (..., modules) each.
    """
    x, y = module_velocities(twist, positions).unbind(-1)
    speed = torch.hypot(x, y)
    turn = torch.remainder(torch.atan2(y, x) - angle + math.pi, 2.0 * math.pi) - math.pi
    backward = turn.abs() > 0.5 * math.pi
    turn = torch.where(backward, turn - math.pi * torch.sign(turn), turn)
    turn = torch.where(speed > 0.0, turn, torch.zeros_like(turn))
    return angle + turn, torch.where(backward, -speed, speed)


def heading_of(
    twist: Float[Tensor, "samples 3"], time: Float[Tensor, " samples"]
) -> Float[Tensor, " samples"]:
    """Return the yaw angle turned since the first sample, (samples,) rad, by the trapezoid rule.

    Args:
        twist: of the chassis at each sample, (samples, 3).
        time: of each sample, (samples,) s.
    """
    steps = 0.5 * torch.diff(time) * (twist[1:, 2] + twist[:-1, 2])
    return torch.cat([torch.zeros_like(twist[:1, 2]), torch.cumsum(steps, 0)])
