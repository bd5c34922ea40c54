"""What a camera looks at: flat upright gates and other panels in the air, over ground and before a far wall.

All of it is drawn from a random generator, but the gates of a track.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import torch
from jaxtyping import Float
from torch import Tensor

from simgap.gates.track import Track
from simgap.perception.settings import ImageSettings
from simgap.physics import rotations

_WAVES = 3  # of the texture of ground and wall


class Panel(NamedTuple):
    """One panel in each image of a batch.

    Attributes:
        centre: world frame, m.
        axes: rows are normal, left and up.
        outer: half of width and height, m.
        inner: half of width and height of the opening, m; zero where there is none.
    """

    centre: Float[Tensor, "batch 3"]
    axes: Float[Tensor, "batch 3 3"]
    outer: Float[Tensor, "batch 2"]
    inner: Float[Tensor, "batch 2"]


@dataclass(frozen=True)
class Scene:
    """Panels of which the first are gates, for each image of a batch.

    Attributes:
        centres: world frame, m.
        axes: rows are normal, left and up.
        outer: half of width and height, m.
        inner: half of width and height of the opening, m; zero where there is none.
        shade: brightness over that of full light.
        stripes: wave vector of the print along left and up, rad/m.
        contrast: of print and texture.
        ground: height, m.
        surroundings: brightness of ground and wall.
        waves: of the texture: wave vector and phase, on the ground in rad/m, on the wall for a unit vector.
    """

    centres: Float[Tensor, "batch panels 3"]
    axes: Float[Tensor, "batch panels 3 3"]
    outer: Float[Tensor, "batch panels 2"]
    inner: Float[Tensor, "batch panels 2"]
    shade: Float[Tensor, "batch panels"]
    stripes: Float[Tensor, "batch panels 2"]
    contrast: Float[Tensor, " batch"]
    ground: Float[Tensor, " batch"]
    surroundings: Float[Tensor, "batch 2"]
    waves: Float[Tensor, "batch 2 waves 4"]

    def panel(self, index: int) -> Panel:
        """Return one of the panels."""
        return Panel(self.centres[:, index], self.axes[:, index], self.outer[:, index], self.inner[:, index])


def uniform(ends: list[float], shape: tuple[int, ...], random: torch.Generator) -> Tensor:
    """Return numbers between two ends."""
    low, high = ends
    return low + (high - low) * torch.rand(shape, generator=random, device=random.device)


def scene_around(
    track: Track,
    position: Float[Tensor, "batch 3"],
    ground: Float[Tensor, " batch"],
    settings: ImageSettings,
    random: torch.Generator,
) -> Scene:
    """Return gates among random panels.

    Args:
        track: its gates, one track for all images or one for each.
        position: from where it is looked at, world frame, m; panels in the foreground stand around it.
        ground: height, m.
        settings: of the panels.
        random: on the device where images are to be drawn.
    """
    batch, gates = len(position), track.centres.shape[-2]
    clutter = _panels(position, settings.clutter, settings.clutter_distance, settings.clutter_size, random)
    covers = _panels(position, settings.covers, settings.cover_distance, settings.cover_size, random)
    centres, axes, outer = (
        torch.cat(part, dim=1) for part in zip(_gates(track, position), clutter, covers, strict=True)
    )
    inner = torch.zeros_like(outer)
    inner[:, :gates] = 0.5 * track.opening
    return Scene(
        centres,
        axes,
        outer,
        inner,
        _shades(batch, gates, outer.shape[1], settings, random),
        stripes=_stripes(batch, gates, outer.shape[1], random),
        contrast=uniform([0.0, 0.3], (batch,), random),
        ground=ground,
        surroundings=uniform([0.05, 0.6], (batch, 2), random),
        waves=_waves(batch, random),
    )


def _gates(track: Track, position: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    batch, gates = len(position), track.centres.shape[-2]
    outer = position.new_full((batch, gates, 2), 0.5 * track.opening + track.frame)
    return (
        track.centres.to(position).expand(batch, gates, 3),
        track.axes.to(position).expand(batch, gates, 3, 3),
        outer,
    )


def _panels(
    position: Tensor, count: int, distance: list[float], size: list[float], random: torch.Generator
) -> tuple[Tensor, Tensor, Tensor]:
    """Return panels in all directions and turned at will: middles, axes, half of width and height."""
    shape = (len(position), count)
    away = torch.nn.functional.normalize(_normal((*shape, 3), random), dim=-1)
    centres = position[:, None] + uniform(distance, (*shape, 1), random) * away
    turns = rotations.to_matrix(rotations.normalize(_normal((*shape, 4), random)))
    logarithms = [math.log(end) for end in size]
    return centres, turns, uniform(logarithms, (*shape, 2), random).exp()


def _shades(batch: int, gates: int, panels: int, settings: ImageSettings, random: torch.Generator) -> Tensor:
    """Return the brightness of gates, which is the same for all in an image, and of other panels."""
    shade = uniform([0.0, 1.0], (batch, panels), random)
    shade[:, :gates] = uniform(settings.gate, (batch, 1), random)
    return shade


def _stripes(batch: int, gates: int, panels: int, random: torch.Generator) -> Tensor:
    """Return the print of panels; gates have none."""
    stripes = uniform([-12.0, 12.0], (batch, panels, 2), random)
    stripes[:, :gates] = 0.0
    return stripes


def _waves(batch: int, random: torch.Generator) -> Tensor:
    waves = _normal((batch, 2, _WAVES, 4), random)
    scale = torch.tensor([1.5, 8.0], device=random.device)[:, None, None]  # rad/m, rad
    waves[..., :3] *= scale
    waves[..., 3] *= math.pi
    return waves


def _normal(shape: tuple[int, ...], random: torch.Generator) -> Tensor:
    return torch.randn(shape, generator=random, device=random.device)
