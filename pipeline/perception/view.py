"""The gates of a track in the camera of a machine."""

import math
from dataclasses import dataclass

import torch
from jaxtyping import Bool, Float
from torch import Tensor

from simgap.gates.track import Track
from simgap.perception.camera import Camera, in_camera, project, sees, unproject
from simgap.physics import rotations
from simgap.physics.shapes import Quaternion, Vector

Corners = Float[Tensor, "gates 4 2"]

_SMALL = 1e-3  # of a distance
_FROM_BEHIND = [1, 0, 3, 2]  # the corners of a gate with left and right exchanged


@dataclass(frozen=True)
class View:
    """What a camera sees of each gate of a track.

    Attributes:
        corners: of the openings, px: left up, right up, right down, left down as the camera sees them, from before the
            gate and from behind alike. A gate's up stays up, however the camera is rolled.
        points: the same corners in the camera's frame, m.
        inside: whether a corner is in front of the camera and inside its image. Nothing hides it.
    """

    corners: Float[Tensor, "*batch gates 4 2"]
    points: Float[Tensor, "*batch gates 4 3"]
    inside: Bool[Tensor, "*batch gates 4"]

    @property
    def visible(self) -> Bool[Tensor, "*batch gates"]:
        """Whether all four corners are inside the image."""
        return self.inside.all(-1)


def as_in_image(
    seen: View, shown: Bool[Tensor, "*batch gates 4"]
) -> tuple[View, Bool[Tensor, "*batch gates 4"]]:
    """Return corners in the order that a detector finds them: the first is left up in the image itself.

    An upright square looks the same after a quarter of a turn, so that a rolled camera cannot tell which of its corners
    is left up. The order around the gate stays; it begins elsewhere.

    Args:
        seen: corners in the order of the gates.
        shown: something else of each corner.
    """
    up = seen.corners[..., :2, :].sum(-2) - seen.corners[..., 2:, :].sum(-2)
    quarters = (torch.atan2(up[..., 0], -up[..., 1]) / (0.5 * math.pi)).round().long()
    order = (torch.arange(4, device=up.device) - quarters[..., None]) % 4
    corners, points = (
        part.gather(-2, order[..., None].expand_as(part)) for part in (seen.corners, seen.points)
    )
    return View(corners, points, seen.inside.gather(-1, order)), shown.gather(-1, order)


def upright(camera: Camera, corners: Corners, attitude: Float[Tensor, "4"]) -> Corners:
    """Return corners in the order of their gates, which stand upright.

    Args:
        camera: on the machine.
        corners: of each gate, in order around it as the image shows it, clockwise, from any of them, px.
        attitude: of the machine, body to world.
    """
    rays = torch.nn.functional.normalize(unproject(camera, corners).sum(-2), dim=-1)
    up = camera.axes.to(rays) @ rotations.to_matrix(attitude.to(rays))[2]
    ways = project(camera, rays + _SMALL * up) - project(camera, rays)
    orders = torch.stack([corners.roll(-first, -2) for first in range(4)])
    lean = orders[..., :2, :].sum(-2) - orders[..., 2:, :].sum(-2)
    first = (lean * ways).sum(-1).argmax(0)
    return orders[first, torch.arange(len(corners))]


def view(camera: Camera, track: Track, position: Vector, attitude: Quaternion) -> View:
    """Return what a camera sees.

    Args:
        camera: on the machine.
        track: its gates, the same for the whole batch or one track for each.
        position: of the machine, world frame, (*batch, 3) m.
        attitude: of the machine, body to world, (*batch, 4).
    """
    placed = track.corners.to(position)
    corners = in_camera(camera, position[..., None, None, :], attitude[..., None, None, :], placed)
    away = rotations.cross(corners[..., 1, :] - corners[..., 0, :], corners[..., 3, :] - corners[..., 0, :])
    behind = (away * corners[..., 0, :]).sum(-1) < 0
    corners = torch.where(behind[..., None, None], corners[..., _FROM_BEHIND, :], corners)
    return View(project(camera, corners), corners, sees(camera, corners))


def distances(
    camera: Camera, track: Track, position: Vector, attitude: Quaternion
) -> Float[Tensor, "*batch gates"]:
    """Return how far the gates in view are, m; infinite for those that are not wholly in the image.

    Args:
        camera: on the machine.
        track: its gates.
        position: of the machine, world frame, (*batch, 3) m.
        attitude: of the machine, body to world, (*batch, 4).
    """
    away = torch.linalg.vector_norm(track.centres.to(position) - position[..., None, :], dim=-1)
    visible = view(camera, track, position, attitude).visible
    return torch.where(visible, away, torch.inf)
