"""The equations of motion of every kind of machine, linear in their parameters, on the features of a layout.

quadrotor  dv/dt = g + thrust, inflow, translational lift along body z; rotor and body drag along x and y
           dω/dt = each rotor's torque, damping, blade flapping, gyroscopic terms of body and rotors
joint      dv/dt = input, viscous and dry friction, gravity or spring, a constant load
swerve     dv/dt = voltage, back-EMF with viscous friction, and dry friction of each motor

Each rotor has a coefficient of its own about each axis: its lever arm, direction and coefficient over the inertia.
Source: Mahony, Kumar & Corke 2012, "Multirotor aerial vehicles", IEEE Robotics & Automation Magazine 19(3).
"""

from collections.abc import Callable

import torch
from torch import Tensor

Terms = tuple[Tensor, ...]
"""What is summed up with one coefficient each, (...)."""

GRAVITY = 9.81  # m/s²


def quadrotor_terms(features: Tensor) -> list[Terms]:
    """Return the terms of body-frame velocity and body rate, from the features of `QuadrotorLayout`."""
    x, y, z, _, _, _, p, q, r, *squared = features.unbind(-1)
    rotors = torch.stack(squared, dim=-1).clamp_min(0.0).sqrt()
    total, lift = rotors.sum(-1), features[..., 9:].sum(-1)
    airspeed = torch.linalg.vector_norm(features[..., :3], dim=-1)
    spin_p, spin_q = ((rate[..., None] * rotors).unbind(-1) for rate in (p, q))
    return [
        (total * x, airspeed * x),
        (total * y, airspeed * y),
        (lift, total * z, total * torch.hypot(x, y)),
        (*squared, p, total * y, q * r, *spin_q),
        (*squared, q, total * x, p * r, *spin_p),
        (*squared, r, p * q),
    ]


def quadrotor_known(features: Tensor) -> Tensor:
    """Return gravity in the body frame, m/s², and no known angular acceleration."""
    gravity = GRAVITY * features[..., 3:6]
    return torch.cat([gravity, torch.zeros_like(gravity)], dim=-1)


def joint_terms(features: Tensor) -> list[Terms]:
    """Return the terms of a joint's acceleration, from the features of `JointLayout`.

    A turning joint is pulled back by gravity, and held aside by an eccentric load; a sliding one by a spring.
    """
    *place, velocity, action = features.unbind(-1)
    return [(action, velocity, torch.sign(velocity), *place, torch.ones_like(velocity))]


def swerve_terms(features: Tensor) -> list[Terms]:
    """Return the terms of each motor's acceleration, from the features of `SwerveLayout`."""
    velocities, voltages = features[..., :8].unbind(-1), features[..., -8:].unbind(-1)
    return [
        (voltage, velocity, torch.sign(velocity))
        for voltage, velocity in zip(voltages, velocities, strict=True)
    ]


TERMS: dict[str, Callable[[Tensor], list[Terms]]] = {
    "quadrotor": quadrotor_terms,
    "joint": joint_terms,
    "swerve": swerve_terms,
}
"""By kind of the layout, the terms of every target."""

KNOWN: dict[str, Callable[[Tensor], Tensor]] = {"quadrotor": quadrotor_known}
"""By kind of the layout, the part of the acceleration that needs no parameter; none elsewhere."""
