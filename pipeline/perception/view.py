"""The gates of a track in the camera of a machine."""

from dataclasses import dataclass

import torch
from jaxtyping import Bool, Float
from torch import Tensor

from simgap.gates.track import Track
from simgap.perception.camera import Camera, in_camera, project, sees
from simgap.physics import rotations
from simgap.physics.shapes import Quaternion, Vector

_FROM_BEHIND = [1, 0, 3, 2]  # the corners of a gate with left and right exchanged


@dataclass(frozen=True)
class View:
    """What a camera sees of each gate of a track.

    Attributes:
        corners: of the openings, px: left up, right up, right down, left down as the camera sees them, from before the
            gate and from behind alike. A gate's up stays up, however the camera is rolled.
        visible: whether all four corners are in front of the camera and inside its image. Nothing hides a gate.
    """

    corners: Float[Tensor, "*batch gates 4 2"]
    visible: Bool[Tensor, "*batch gates"]


def view(camera: Camera, track: Track, position: Vector, attitude: Quaternion) -> View:
    """Return what a camera sees.

    Args:
        camera: on the machine.
        track: its gates.
        position: of the machine, world frame, (*batch, 3) m.
        attitude: of the machine, body to world, (*batch, 4).
    """
    placed = track.corners.to(position)
    corners = in_camera(camera, position[..., None, None, :], attitude[..., None, None, :], placed)
    away = rotations.cross(corners[..., 1, :] - corners[..., 0, :], corners[..., 3, :] - corners[..., 0, :])
    behind = (away * corners[..., 0, :]).sum(-1) < 0
    corners = torch.where(behind[..., None, None], corners[..., _FROM_BEHIND, :], corners)
    return View(project(camera, corners), sees(camera, corners).all(-1))
