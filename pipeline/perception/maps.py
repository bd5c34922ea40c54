"""What a detector is to find: a map for each corner of a gate, and a field for each edge.

A corner's map is a bell around it. An edge's field points from its first corner to its second, and is zero elsewhere
(part-affinity fields; Cao et al. 2017, CVPR). A straight edge is a great circle for the lens, whatever its distortion.
"""

import torch
from jaxtyping import Bool, Float
from torch import Tensor

from simgap.perception.camera import Camera, unproject
from simgap.perception.fused import fused
from simgap.perception.settings import DetectorSettings
from simgap.perception.view import View, as_in_image
from simgap.physics import rotations

CORNERS = 4
CHANNELS = 3 * CORNERS  # four maps, and two components of four fields


def targets(
    camera: Camera, seen: View, shown: Bool[Tensor, "batch gates 4"], settings: DetectorSettings
) -> Float[Tensor, "batch 12 height width"]:
    """Return maps and fields: four corners as the image shows them, then x and y of the edges that begin at each.

    Args:
        camera: that sees the gates.
        seen: what it sees of them.
        shown: corners that are to be found; an edge is where both its corners are.
        settings: sizes of bells and edges.
    """
    seen, shown = as_in_image(seen, shown)
    return torch.cat((_bells(camera, seen, shown, settings), _fields(camera, seen, shown, settings)), dim=1)


def _bells(camera: Camera, seen: View, shown: Tensor, settings: DetectorSettings) -> Tensor:
    away = [
        torch.exp(
            -0.5 * ((torch.arange(size).to(seen.corners) - seen.corners[..., [axis]]) / settings.corner) ** 2
        )
        for axis, size in enumerate(camera.size)
    ]
    across, down = away[0] * shown[..., None], away[1]
    maps = across.new_zeros(len(across), CORNERS, camera.size[1], camera.size[0])
    higher = fused(_with_bells, maps.device)
    for gate in range(across.shape[1]):
        maps = higher(maps, across[:, gate], down[:, gate])
    return maps


def _with_bells(maps: Tensor, across: Tensor, down: Tensor) -> Tensor:
    """Return maps (batch, 4, height, width) with the corners of one more gate: their bells along x and along y."""
    return torch.maximum(maps, down[..., :, None] * across[..., None, :])


def _fields(camera: Camera, seen: View, shown: Tensor, settings: DetectorSettings) -> Tensor:
    batch, gates = shown.shape[:2]
    width, height = camera.size
    across, down = (torch.arange(size).to(seen.corners) for size in (width, height))
    pixels = torch.stack(torch.meshgrid(across, down, indexing="xy"), dim=-1).view(-1, 2)
    rays = unproject(camera, pixels).T
    points = torch.nn.functional.normalize(seen.points.to(rays), dim=-1)
    fields = rays.new_zeros(batch, CORNERS, 2, height * width)
    drawn = fused(_with_edges, rays.device)
    for gate in range(gates):
        ends = (points[:, gate], seen.corners[:, gate].to(rays), shown[:, gate])
        fields = drawn(fields, rays, *ends, settings.edge / camera.focal[0])
    return fields.view(batch, 2 * CORNERS, height, width)


def _with_edges(
    fields: Tensor, rays: Tensor, points: Tensor, corners: Tensor, shown: Tensor, angle: float
) -> Tensor:
    """Return fields (batch, 4, 2, rays) with the edges of one more gate.

    Args:
        fields: so far.
        rays: of the pixels, (3, rays).
        points: directions of the gate's corners, (batch, 4, 3).
        corners: the same in the image, (batch, 4, 2) px.
        shown: whether they are to be found, (batch, 4) bool.
        angle: half the width of an edge, rad.
    """
    first, second = points, points.roll(-1, 1)
    normal = torch.nn.functional.normalize(rotations.cross(first, second), dim=-1)
    after, before = rotations.cross(normal, first), rotations.cross(second, normal)
    across, after, before = (_along(each, rays) for each in (normal, after, before))
    on_edge = (across.abs() < angle) & (after > 0) & (before > 0) & (shown & shown.roll(-1, 1))[..., None]
    way = torch.nn.functional.normalize(corners.roll(-1, 1) - corners, dim=-1)
    return torch.where(on_edge[:, :, None], way[..., None], fields)


def _along(vectors: Tensor, rays: Tensor) -> Tensor:
    """Return products of vectors (batch, 4, 3) with rays (3, rays), (batch, 4, rays)."""
    x, y, z = vectors[..., None].unbind(-2)
    return x * rays[0] + y * rays[1] + z * rays[2]
