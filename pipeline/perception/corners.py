"""The corners of gates, read off the maps of a detector.

Peaks of a map are corners. The field of an edge says how strongly two of them are joined. Of all ways to go around from
a left upper corner by a right upper, right lower and left lower one, the strongest is a gate; then the strongest of
those with corners elsewhere, and so on. All four edges have to be strong enough.

Where a gate leans by half a quarter of a turn, the detector cannot decide where its order begins, and there are peaks
of two kinds at a corner. They are of one gate, since a corner is used once.
"""

from typing import Any

import numpy as np
import torch
from jaxtyping import Float
from numpy.typing import NDArray
from torch import Tensor, nn

from simgap.perception.camera import Camera, project, unproject
from simgap.perception.maps import CORNERS
from simgap.perception.settings import DetectorSettings

Array = NDArray[Any]

_SAMPLES = 12  # of a field along an edge
_APART = 3.0  # px, least length of an edge, and least distance of two corners


def gates_in(
    maps: Float[Tensor, "batch 12 height width"], camera: Camera, settings: DetectorSettings
) -> list[NDArray[np.float64]]:
    """Return the corners of the gates of each image, clockwise from the one that is left up, (gates, 4, 2) px each.

    Args:
        maps: of a detector, those of corners between 0 and 1.
        camera: that took the images.
        settings: what is a peak, and what an edge.
    """
    places, certain = _peaks(maps[:, :CORNERS].float(), settings)
    strengths = _strengths(maps[:, CORNERS:].float(), places, camera)
    corners, known = places.cpu().double().numpy(), certain.cpu().numpy()
    return [
        _gates(*each, settings.least_edge)
        for each in zip(corners, known, strengths.cpu().numpy(), strict=True)
    ]


def _peaks(maps: Tensor, settings: DetectorSettings) -> tuple[Tensor, Tensor]:
    """Return the highest peaks of each map (batch, 4, peaks, 2) px, and whether they are high enough."""
    width = maps.shape[-1]
    highest = nn.functional.max_pool2d(maps, 5, stride=1, padding=2)
    heights, index = torch.where(maps == highest, maps, 0.0).flatten(2).topk(settings.peaks)
    around = nn.functional.pad(maps, (1, 1, 1, 1), mode="replicate").clamp(min=1e-6).log().flatten(2)
    wide = width + 2
    middle = (index // width + 1) * wide + index % width + 1
    offsets = [_top(around, middle, step) for step in (1, wide)]
    places = torch.stack((index % width + offsets[0], index // width + offsets[1]), dim=-1)
    return places, heights > settings.least_peak


def _top(logarithms: Tensor, index: Tensor, step: int) -> Tensor:
    """Return by how much the top of the bell through three neighbours is beside the middle one, px."""
    before, here, after = (logarithms.gather(2, index + way) for way in (-step, 0, step))
    bend = (2.0 * here - before - after).clamp(min=1e-6)
    return (0.5 * (after - before) / bend).clamp(-0.5, 0.5)


def _strengths(fields: Tensor, places: Tensor, camera: Camera) -> Tensor:
    """Return the mean field along the edges from each corner to each of the next kind, (batch, 4, peaks, peaks)."""
    batch, _, peaks, _ = places.shape
    height, width = fields.shape[-2:]
    rays = unproject(camera, places)
    first, second = rays[:, :, :, None, None], rays.roll(-1, 1)[:, :, None, :, None]
    share = torch.linspace(0.0, 1.0, _SAMPLES).to(rays)[:, None]
    x, y = project(camera, (1.0 - share) * first + share * second).round().long().unbind(-1)
    index = (y.clamp(0, height - 1) * width + x.clamp(0, width - 1)).view(batch, CORNERS, 1, -1)
    flat = fields.view(batch, CORNERS, 2, -1)
    sampled = flat.gather(3, index.expand(-1, -1, 2, -1)).view(batch, CORNERS, 2, peaks, peaks, _SAMPLES)
    way = nn.functional.normalize(places.roll(-1, 1)[:, :, None] - places[:, :, :, None], dim=-1)
    return (sampled * way.movedim(-1, 2)[..., None]).sum(2).mean(-1)


def _gates(places: Array, known: Array, strengths: Array, least: float) -> Array:
    """Return the gates of an image, (gates, 4, 2) px, the strongest first.

    Args:
        places: of the peaks of each kind, (4, peaks, 2) px.
        known: which of them are corners, (4, peaks) bool.
        strengths: of the edges from each to each of the next kind, (4, peaks, peaks).
        least: strength of an edge.
    """
    corners = [place[sure] for place, sure in zip(places, known, strict=True)]
    edges = [
        np.where(_far(corners[kind], corners[after]), strength[known[kind]][:, known[after]], -np.inf)
        for kind, strength in enumerate(strengths)
        for after in [(kind + 1) % CORNERS]
    ]
    first, second, third, fourth = (np.where(edge > least, edge, -np.inf) for edge in edges)
    around = (
        first[:, :, None, None] + second[None, :, :, None] + third[None, None] + fourth.T[:, None, None, :]
    )
    found: list[Array] = []
    while around.size and np.isfinite(around.max()):
        best = np.unravel_index(around.argmax(), around.shape)
        found.append(np.stack([corners[kind][index] for kind, index in enumerate(best)]))
        for kind, each in enumerate(corners):
            used = ~_far(each, found[-1]).all(-1)
            around[(slice(None),) * kind + (used,)] = -np.inf
    return np.array(found).reshape(-1, CORNERS, 2)


def _far(some: Array, others: Array) -> Array:
    """Return whether places are apart, (some, others) bool."""
    return np.linalg.norm(some[:, None] - others, axis=-1) > _APART
