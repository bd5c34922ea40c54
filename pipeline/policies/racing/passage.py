"""Detection of passing a gate or hitting its frame."""

from dataclasses import dataclass

import torch
from torch import Tensor

from simgap.gates.track import Track


@dataclass(frozen=True)
class Passage:
    """What happened at the gates between two instants.

    Attributes:
        passed: the gate that was to be passed was passed in its direction, (batch,) bool.
        hit: the frame of some gate was touched, (batch,) bool.
        missed: the gate that was to be passed was flown past beside its frame, within reach, (batch,) bool.
        margin: where the gate was passed, distance to the nearest edge of the opening, (batch,) m.
    """

    passed: Tensor
    hit: Tensor
    missed: Tensor
    margin: Tensor


def passage(track: Track, before: Tensor, after: Tensor, target: Tensor, reach: float = 0.0) -> Passage:
    """Return what happened at the gates on straight lines.

    Args:
        track: its gates.
        before: positions, (batch, 3) m.
        after: positions, (batch, 3) m.
        target: index of the gate that each machine is to pass, (batch,).
        reach: beside the frame within which a gate can be missed, m; further away its plane means nothing.
    """
    start, end = (_in_gates(track, position) for position in (before, after))  # (batch, gates, 3)
    depth, further = start[..., 0], end[..., 0]
    crossed = (depth < 0) != (further < 0)
    share = depth / torch.where(crossed, depth - further, torch.ones_like(depth))
    point = start[..., 1:] + share[..., None] * (end[..., 1:] - start[..., 1:])
    margin = 0.5 * track.opening - point.abs().amax(-1)  # (batch, gates), negative beside the opening
    open_ = margin >= track.clearance
    beside = -(track.frame + track.clearance)
    hit = crossed & ~open_ & (margin > beside)
    forward, past = crossed & (depth < 0), (margin <= beside) & (margin > beside - reach)
    of_target = [part.gather(1, target[:, None])[:, 0] for part in (forward & open_, forward & past, margin)]
    return Passage(of_target[0], hit.any(1), of_target[1], of_target[2])


def _in_gates(track: Track, position: Tensor) -> Tensor:
    """Return positions in the axes of every gate, (batch, gates, 3) m: depth behind its plane, left, up."""
    relative = position[:, None] - track.centres
    return (track.axes * relative[:, :, None]).sum(-1)
