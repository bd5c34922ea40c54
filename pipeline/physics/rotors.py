"""Identical rotors with thrust along body +z and reaction torque about z.

Quadratic laws in rotor speed (Mahony, Kumar & Corke 2012, "Multirotor aerial vehicles"). Rotors are the last
dimension, (..., rotors); vectors per rotor are (..., rotors, 3).
"""

import torch
from jaxtyping import Float
from torch import Tensor

from simgap.physics.rotations import cross
from simgap.physics.shapes import Signal, Vector

PerRotor = Float[Tensor, "*#batch rotors"]
RotorVectors = Float[Tensor, "*#batch rotors 3"]


def thrust(speed: PerRotor, coefficient: float | Signal) -> PerRotor:
    """Return the thrust of each rotor, N.

    Args:
        speed: rotor speed, rad/s.
        coefficient: N/(rad/s)².
    """
    return coefficient * speed.square()


def reaction_torque(speed: PerRotor, coefficient: float | Signal, directions: PerRotor) -> PerRotor:
    """Return the torque of each rotor's air drag on the body about +z, N·m.

    Args:
        speed: rotor speed, rad/s.
        coefficient: N·m/(rad/s)².
        directions: +1 where the torque on the body is about +z, −1 where about −z.
    """
    return coefficient * directions * speed.square()


def shaft_power(speed: PerRotor, coefficient: float | Signal) -> PerRotor:
    """Return the power that each rotor takes from its shaft, W.

    Args:
        speed: rotor speed, rad/s.
        coefficient: reaction torque over squared speed, N·m/(rad/s)².
    """
    return coefficient * speed.abs() * speed.square()


def wrench(lift: PerRotor, reaction: PerRotor, positions: RotorVectors) -> tuple[Vector, Vector]:
    """Return the force (N) and the torque about the origin (N·m) of all rotors on the body, body frame.

    Args:
        lift: thrust of each rotor along +z, N.
        reaction: torque of each rotor on the body about +z, N·m.
        positions: of the hubs, body frame, m.
    """
    total = lift.sum(dim=-1)
    roll = (positions[..., 1] * lift).sum(dim=-1)
    pitch = -(positions[..., 0] * lift).sum(dim=-1)
    yaw = reaction.sum(dim=-1).expand_as(roll)
    force = torch.stack((torch.zeros_like(total), torch.zeros_like(total), total), dim=-1)
    return force, torch.stack((roll, pitch, yaw), dim=-1)


def hub_velocity(velocity: Vector, body_rate: Vector, positions: RotorVectors) -> RotorVectors:
    """Return the velocity of each hub through still air, v + ω × r, body frame, m/s.

    Args:
        velocity: of the origin, body frame, m/s.
        body_rate: body frame, rad/s.
        positions: of the hubs, body frame, m.
    """
    return velocity[..., None, :] + cross(body_rate[..., None, :], positions)
