"""The rigid body: Newton and Euler (Goldstein, "Classical Mechanics", chapters 4 and 5).

Inertia is given by its principal moments along the body axes, (..., 3) in kg·m².
"""

import torch

from simgap.physics.rotations import cross, rotate
from simgap.physics.shapes import Quaternion, Real, Signal, Vector


def linear_acceleration(attitude: Quaternion, specific_force: Vector, gravity: float | Signal) -> Vector:
    """Return the acceleration of the centre of mass in the world frame, m/s².

    Args:
        attitude: unit quaternion, body to world.
        specific_force: all forces but weight over mass, body frame, m/s².
        gravity: m/s², along −z of the world.
    """
    lifted = rotate(attitude, specific_force)
    return torch.cat((lifted[..., :2], lifted[..., 2:] - gravity), dim=-1)


def angular_acceleration(body_rate: Vector, torque: Vector, inertia: Vector) -> Vector:
    """Return dω/dt = J⁻¹(τ − ω × Jω) in the body frame, rad/s² (Euler's equations).

    Args:
        body_rate: ω, body frame, rad/s.
        torque: τ about the centre of mass, body frame, N·m.
        inertia: principal moments J, kg·m².
    """
    return (torque - cross(body_rate, inertia * body_rate)) / inertia


def gyroscopic_torque(body_rate: Vector, spin_momentum: Vector) -> Vector:
    """Return −ω × h, the gyroscopic torque of carried angular momentum on a rotating body, N·m.

    Args:
        body_rate: ω, body frame, rad/s.
        spin_momentum: angular momentum h of the rotors relative to the body, body frame, kg·m²/s.
    """
    return cross(spin_momentum, body_rate)


def angular_momentum(attitude: Quaternion, body_rate: Vector, inertia: Vector) -> Vector:
    """Return the angular momentum about the centre of mass in the world frame, kg·m²/s."""
    return rotate(attitude, inertia * body_rate)


def rotational_energy(body_rate: Vector, inertia: Vector) -> Real:
    """Return the kinetic energy of rotation ½ ω·Jω, J."""
    return 0.5 * (inertia * body_rate.square()).sum(dim=-1)
