"""Friction laws: each returns the force (or torque) on the moving body, which opposes its velocity.

Olsson, Åström, Canudas de Wit, Gäfvert & Lischinsky 1998, "Friction models and friction compensation".
Velocities in m/s or rad/s, levels in N or N·m.
"""

import torch

from simgap.physics.shapes import Real, Value


def direction(velocity: Real, smoothing: float = 0.0) -> Real:
    """Return the sign of the velocity, or the smooth tanh(velocity / smoothing) where gradients are needed.

    Args:
        velocity: of the body.
        smoothing: velocity at which the smooth sign has reached 0.76; 0 for the exact sign.
    """
    return torch.tanh(velocity / smoothing) if smoothing > 0 else torch.sign(velocity)


def coulomb(velocity: Real, level: Value, smoothing: float = 0.0) -> Real:
    """Return dry friction of constant level."""
    return -level * direction(velocity, smoothing)


def viscous(velocity: Real, coefficient: Value) -> Real:
    """Return friction proportional to velocity; coefficient in N/(m/s) or N·m/(rad/s)."""
    return -coefficient * velocity


def stribeck_level(velocity: Real, kinetic: Value, static: Value, stribeck_velocity: Value) -> Real:
    """Return the level of friction, which falls from static to kinetic over the Stribeck velocity."""
    return kinetic + (static - kinetic) * torch.exp(-((velocity / stribeck_velocity) ** 2))


def stribeck(
    velocity: Real, kinetic: Value, static: Value, stribeck_velocity: Value, smoothing: float = 0.0
) -> Real:
    """Return dry friction with the Stribeck effect."""
    return -stribeck_level(velocity, kinetic, static, stribeck_velocity) * direction(velocity, smoothing)


def lugre_bristle_rate(deflection: Real, velocity: Real, level: Value, stiffness: Value) -> Real:
    """Return the rate of the mean bristle deflection, dz/dt = v − σ₀|v|z / g(v).

    Canudas de Wit, Olsson, Åström & Lischinsky 1995, "A new model for control of systems with friction".

    Args:
        deflection: z, m or rad.
        velocity: v, of the body.
        level: g(v), e.g. from `stribeck_level`.
        stiffness: σ₀ of the bristles, N/m or N·m/rad.
    """
    return velocity - stiffness * torch.abs(velocity) / level * deflection


def lugre_bristle_step(deflection: Real, velocity: Real, level: Value, stiffness: Value, dt: float) -> Real:
    """Return the bristle deflection dt later, exact for a held velocity (the rate is linear in z)."""
    exponent = stiffness * torch.abs(velocity) / level * dt
    safe = torch.where(exponent > 0, exponent, torch.ones_like(exponent))
    share = torch.where(exponent > 0, -torch.expm1(-safe) / safe, torch.ones_like(exponent))
    return deflection * torch.exp(-exponent) + velocity * dt * share


def lugre(deflection: Real, rate: Real, stiffness: Value, damping: Value) -> Real:
    """Return the LuGre bristle force −(σ₀ z + σ₁ dz/dt); add `viscous` for lubricated contact.

    Args:
        deflection: z, m or rad.
        rate: dz/dt, from `lugre_bristle_rate`.
        stiffness: σ₀.
        damping: σ₁ of the bristles, N/(m/s) or N·m/(rad/s).
    """
    return -(stiffness * deflection + damping * rate)
