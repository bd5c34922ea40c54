"""Induced velocity of a rotor by momentum theory, with Glauert's rule for oblique flow.

Source: Leishman 2006, Principles of helicopter aerodynamics, §2.14 and §3.2.
"""

import torch
from torch import Tensor

from simgap.physics.shapes import Real, Value

_ITERATIONS = 20
_STILL = 1e-6  # m/s, taken as still air
_FOLD = 0.1  # of the blades' slope, which is bounded there: in its own wake a rotor has no steady inflow


def induced_velocity(still: Real, crossing: Real, climb: Real, sensitivity: Value) -> Real:
    """Return the induced velocity at which blade elements and momentum give the same thrust, m/s.

    Newton's method finds it without gradients; one last step adds the exact gradients.

    Args:
        still: induced velocity in still air at this rotor speed, m/s.
        crossing: square of the airspeed in the disc's plane, m²/s².
        climb: airspeed along the axis, m/s.
        sensitivity: of the thrust to the air through the disc; 0: the rotor holds its thrust in still air (Glauert).
    """
    sensitivity = torch.as_tensor(sensitivity, dtype=still.dtype, device=still.device)
    known = (still.detach(), crossing.detach(), climb.detach(), sensitivity.detach())
    induced, blades = known[0], known[3].clamp_min(_FOLD) * known[0] + _STILL
    for _ in range(_ITERATIONS):
        excess, slope = _disagreement(induced, *known)
        induced = induced - excess / slope.maximum(blades)
    _, slope = _disagreement(induced, *known)
    excess, _ = _disagreement(induced, still, crossing, climb, sensitivity)
    return induced - excess / slope.maximum(_FOLD * blades)


def _disagreement(
    induced: Tensor, still: Tensor, crossing: Tensor, climb: Tensor, sensitivity: Tensor
) -> tuple[Tensor, Tensor]:
    """Return the thrust by momentum less that by blade elements, over 2·density·area, m²/s², and its slope, m/s."""
    through = climb + induced
    resultant = (crossing + through.square() + _STILL**2).sqrt()
    blades = still * ((1.0 + sensitivity) * still - sensitivity * through)
    slope = sensitivity * still + resultant + induced * through / resultant
    return induced * resultant - blades, slope
