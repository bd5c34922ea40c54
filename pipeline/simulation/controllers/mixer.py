"""Control allocation: from commanded thrust and torque to rotor thrusts, for any rotor geometry."""

import torch
from jaxtyping import Float
from torch import Tensor

from simgap.errors import InputError
from simgap.physics.shapes import PerModule, Real, Vector
from simgap.platforms import Quadrotor


def allocation(platform: Quadrotor) -> Float[Tensor, "4 4"]:
    """Return the matrix from the thrusts of the rotors to [thrust, torque about x, y, z], (4, 4) float64.

    Source: Mahony, Kumar & Corke 2012, "Multirotor aerial vehicles", eq. 2.
    """
    positions = torch.tensor(platform.rotor_positions, dtype=torch.float64)
    directions = torch.tensor(platform.rotor_directions, dtype=torch.float64)
    arm = platform.torque_coefficient / platform.thrust_coefficient
    return torch.stack([torch.ones(4).double(), positions[:, 1], -positions[:, 0], arm * directions])


def distribution(platform: Quadrotor) -> Float[Tensor, "4 4"]:
    """Return the inverse of the allocation, (4, 4) float64: column 0 spreads a thrust without torque.

    Raises:
        InputError: when the rotors cannot hold the body level, or not turn it about every axis.
    """
    matrix = allocation(platform)
    remedy = "put the rotors around the centre of mass, with neighbours turning in opposite senses"
    if torch.linalg.matrix_rank(matrix) < 4:
        raise InputError("the rotors cannot turn the body about every axis", "rotor_positions", remedy)
    inverse = torch.linalg.inv(matrix)
    if not bool((inverse[:, 0] > 0).all()):
        raise InputError("the rotors cannot carry the body without turning it", "rotor_positions", remedy)
    return inverse


def mix(
    thrust: Real, torque: Vector, spread: Float[Tensor, "4 4"], least: Float[Tensor, "4"], most: float
) -> PerModule:
    """Return the thrust of each rotor, (..., 4) N; under saturation the direction of the torque is kept.

    A rotor that would fall below its least thrust raises the thrust of all (Betaflight's air mode); one that would
    exceed the greatest scales all down, thrust and torque alike: the rates have priority over the thrust (Kaufmann et
    al. 2023, Nature 620, Methods).

    Args:
        thrust: wanted in all, (...,) N.
        torque: wanted about the body axes, (..., 3) N·m.
        spread: of `distribution`, (4, 4).
        least: of each rotor when the throttle idles, (4,) N, in the proportion of the first column of `spread`.
        most: of each rotor, N.
    """
    level = spread[:, 0]
    twist = (spread[:, 1:] * torque[..., None, :]).sum(-1)
    wanted = (thrust - least.sum())[..., None]
    lift = torch.maximum(wanted, (-twist / level).amax(-1, keepdim=True))
    above = lift * level + twist
    excess = (above / (most - least)).amax(-1, keepdim=True).clamp_min(1.0)
    return least + above / excess
