"""Observations of a racing policy (31 numbers), and the privileged ones of its critic."""

import torch
from torch import Tensor

from simgap.gates.track import Track
from simgap.physics import rotations
from simgap.policies.environment import Observation

POLICY_SIZE = 31
PRIVILEGED_SIZE = 18
# Units in which the numbers are of the order of one.
_LENGTH = 10.0  # m
_SPEED = 10.0  # m/s
_BODY_RATE = 10.0  # rad/s
_ANGULAR_ACCELERATION = 100.0  # rad/s²


def racing_observation(
    track: Track,
    believed: dict[str, Tensor],
    true: dict[str, Tensor],
    acceleration: Tensor,
    target: Tensor,
    previous: Tensor,
) -> Observation:
    """Return what is seen (Kaufmann et al. 2023, Nature 620, Methods).

    The policy sees position (3), velocity (3), rotation matrix (9), the corners of the next gate from the body (12),
    all as the machine believes them to be, and its previous action (4); the critic also the true body rate (3), angular
    acceleration (3) and corners of the gate after the next (12).

    Args:
        track: its gates.
        believed: position, attitude, velocity (world) and body rate, each (batch, ...).
        true: the same, exact.
        acceleration: angular, (batch, 3) rad/s².
        target: index of the next gate, (batch,).
        previous: action within ±1, (batch, 4).
    """
    turn, position = rotations.to_matrix(believed["attitude"]), believed["position"]
    seen = [
        position / _LENGTH,
        believed["velocity"] / _SPEED,
        turn.flatten(1),
        _corners(track, position, turn, target),
        previous,
    ]
    following = (target + 1) % len(track)
    exact = [
        true["body_rate"] / _BODY_RATE,
        acceleration / _ANGULAR_ACCELERATION,
        _corners(track, true["position"], rotations.to_matrix(true["attitude"]), following),
    ]
    return Observation(torch.cat(seen, -1), torch.cat(exact, -1))


def seen_state(seen: Observation) -> tuple[Tensor, Tensor, Tensor]:
    """Return position (batch, 3) m, velocity (batch, 3) m/s and rotation (batch, 3, 3), as a policy sees them."""
    position, velocity, turn = seen.policy[:, :15].split([3, 3, 9], dim=-1)
    return position * _LENGTH, velocity * _SPEED, turn.unflatten(-1, (3, 3))


def _corners(track: Track, position: Tensor, turn: Tensor, target: Tensor) -> Tensor:
    """Return the corners of a gate in the body frame, (batch, 12)."""
    relative = (track.corners[target] - position[:, None]) / _LENGTH
    return (relative @ turn).flatten(1)
