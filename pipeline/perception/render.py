"""Images of a scene by ray casting: a ray for every pixel and instant, cut with the plane of every panel.

A ray looks where its pixel does through the calibrated lens, so that an image is exact for a fisheye also. Light is
averaged over some instants within the shutter, at each of which rays look at another part of their pixels: that blurs
what moves, and smooths edges.
"""

import math
from dataclasses import dataclass

import torch
from jaxtyping import Bool, Float
from torch import Tensor

from simgap.perception.camera import Camera, unproject
from simgap.perception.fused import fused
from simgap.perception.scene import Panel, Scene, uniform
from simgap.perception.settings import ImageSettings
from simgap.perception.view import View
from simgap.physics import rotations

_TOGETHER = {"cpu": 1, "cuda": 64}  # images whose rays are in memory at once
_SAME = 0.999  # of the distance of a corner, at which nothing hides it
_FADES = 10.0  # m, from where the ground's texture cannot be made out


@dataclass(frozen=True)
class Motion:
    """A machine in the middle of the shutter, for each image of a batch.

    Attributes:
        position: world frame, m.
        attitude: body to world.
        velocity: world frame, m/s.
        rate: about the body's axes, rad/s.
    """

    position: Float[Tensor, "batch 3"]
    attitude: Float[Tensor, "batch 4"]
    velocity: Float[Tensor, "batch 3"]
    rate: Float[Tensor, "batch 3"]


class Renderer:
    """Takes images with a camera."""

    def __init__(self, camera: Camera, settings: ImageSettings, device: torch.device | str = "cpu") -> None:
        """Find where each pixel looks.

        Args:
            camera: that takes the images.
            settings: of the images.
            device: where they are drawn.
        """
        self.camera, self.settings, self.device = camera, settings, torch.device(device)
        self._rays = _rays(camera, settings.exposures).to(self.device)
        self._vignette = _radius(camera).to(self.device) ** 2

    def images(
        self, scene: Scene, motion: Motion, random: torch.Generator
    ) -> Float[Tensor, "batch 1 height width"]:
        """Return images, from 0 to 1.

        Args:
            scene: on the renderer's device, as everything here.
            motion: of the machine.
            random: of noise, and of everything that an image draws for itself.
        """
        batch = len(motion.position)
        shutter = uniform(self.settings.shutter, (batch, 1, 1), random)
        where, turn = self._path(motion, shutter)
        parts = [vars(scene)[name].split(_TOGETHER[self.device.type]) for name in vars(scene)]
        wheres, turns = (part.split(_TOGETHER[self.device.type]) for part in (where, turn))
        lights = [
            _light(self._rays, place, axes, Scene(*arrays))
            for place, axes, *arrays in zip(wheres, turns, *parts, strict=True)
        ]
        width, height = self.camera.size
        return self._exposed(torch.cat(lights).view(batch, 1, height, width), random)

    def _path(self, motion: Motion, shutter: Tensor) -> tuple[Tensor, Tensor]:
        """Return places (batch, exposures, 3) m and axes (batch, exposures, 3, 3), camera to world, in the shutter."""
        count = self.settings.exposures
        instants = (torch.arange(count, device=self.device) + 0.5) / count - 0.5
        late = shutter * instants[:, None]
        turned = rotations.from_rotation_vector(late * motion.rate[:, None])
        attitude = rotations.multiply(motion.attitude[:, None], turned)
        body = rotations.to_matrix(attitude)
        offset = self.camera.position.to(body)
        return motion.position[:, None] + late * motion.velocity[:, None] + body @ offset, (
            body @ self.camera.axes.to(body).T
        )

    def _exposed(self, light: Tensor, random: torch.Generator) -> Tensor:
        """Return what the sensor makes of light: lens, exposure, noise, 256 levels."""
        one = (len(light), 1, 1, 1)
        settings = self.settings
        light = _blurred(light, uniform(settings.blur, one, random))
        falloff = 1.0 - uniform(settings.vignetting, one, random) * self._vignette
        level = (uniform(settings.gain, one, random) * falloff * light).clamp(0.0, 1.0)
        shot, read = uniform(settings.shot, one, random), uniform(settings.read, one, random)
        noise = torch.randn(level.shape, generator=random, device=self.device)
        noisy = level + (shot**2 * level + read**2).sqrt() * noise
        return (255.0 * noisy.clamp(0.0, 1.0)).round() / 255.0


def unhidden(scene: Scene, motion: Motion, camera: Camera, seen: View) -> Bool[Tensor, "batch gates 4"]:
    """Return whether corners are inside the image and no other panel stands before them."""
    batch, gates = seen.points.shape[:2]
    body = rotations.to_matrix(motion.attitude)
    where = (motion.position + body @ camera.position.to(body))[:, None]
    turn = (body @ camera.axes.to(body).T)[:, None]
    points = seen.points.to(body).view(batch, 1, 4 * gates, 3)
    distance = points.norm(dim=-1)
    rays = (points / distance[..., None]).transpose(-1, -2)
    nearest = torch.full_like(distance, math.inf)
    for index in range(scene.centres.shape[1]):
        reach, *_ = _cut(rays, where, turn, scene.panel(index))
        nearest = torch.minimum(nearest, reach)
    return seen.inside & (nearest >= _SAME * distance).view(batch, gates, 4)


def _rays(camera: Camera, exposures: int) -> Float[Tensor, "exposures 3 pixels"]:
    """Return where pixels look in the camera's frame at each exposure; zero where the lens draws nothing.

    Within a pixel, rays are spread as the additive recurrence of Roberts (2018) spreads points, around the middle.
    """
    golden = 1.32471795724474602596  # of x³ = x + 1
    steps = torch.arange(exposures, dtype=torch.float64)[:, None]
    spread = (steps * torch.tensor([1.0 / golden, 1.0 / golden**2], dtype=torch.float64)) % 1.0
    spread -= spread.mean(0)
    rays = unproject(camera, _pixels(camera) + spread[:, None])
    drawn = rays[..., 2] > math.cos(camera.widest) + 1e-9
    return (rays * drawn[..., None]).float().transpose(-1, -2).contiguous()


def _pixels(camera: Camera) -> Float[Tensor, "pixels 2"]:
    width, height = (torch.arange(size, dtype=torch.float64) for size in camera.size)
    return torch.stack(torch.meshgrid(width, height, indexing="xy"), dim=-1).view(-1, 2)


def _radius(camera: Camera) -> Float[Tensor, "height width"]:
    """Return how far pixels are from the principal point, over the farthest."""
    away = (_pixels(camera) - torch.tensor(camera.centre, dtype=torch.float64)).norm(dim=-1)
    return (away / away.max()).float().view(camera.size[1], camera.size[0])


def _cut(rays: Tensor, where: Tensor, turn: Tensor, panel: Panel) -> tuple[Tensor, Tensor, Tensor]:
    """Cut rays with a panel.

    Args:
        rays: camera's frame, ([batch], exposures, 3, rays).
        where: the camera, (batch, exposures, 3) m.
        turn: its axes, camera to world, (batch, exposures, 3, 3).
        panel: of each image.

    Returns:
        Distance in lengths of a ray, infinite where it passes by; left and up on the panel, m. Each (batch, exposures,
        rays).
    """
    frame = panel.axes[:, None]
    start = (frame @ (where - panel.centre[:, None])[..., None]).unbind(-2)
    along = _turned(frame @ turn, rays)
    reach = -start[0] / along[0]
    left, up = (start[axis] + reach * along[axis] for axis in (1, 2))
    sideways, upwards = left.abs(), up.abs()
    sizes = [part[:, None, None] for half in (panel.outer, panel.inner) for part in half.unbind(1)]
    solid = (sideways < sizes[0]) & (upwards < sizes[1]) & ~((sideways < sizes[2]) & (upwards < sizes[3]))
    return torch.where(solid & (reach > 0), reach, math.inf), left, up


def _light(rays: Tensor, where: Tensor, turn: Tensor, scene: Scene) -> Tensor:
    """Return the light of pixels seen along a path, (batch, pixels)."""
    background, nearer = fused(_surroundings, rays.device), fused(_nearer, rays.device)
    around = (scene.contrast, scene.ground, scene.surroundings, scene.waves)
    light = background(rays, where, turn, *around)
    nearest = torch.full_like(light, math.inf)
    for index in range(scene.centres.shape[1]):
        print_of = (scene.shade[:, index], scene.stripes[:, index], scene.contrast)
        light, nearest = nearer(light, nearest, rays, where, turn, scene.panel(index), print_of)
    return light.mean(1)


def _nearer(
    light: Tensor,
    nearest: Tensor,
    rays: Tensor,
    where: Tensor,
    turn: Tensor,
    panel: Panel,
    print_of: tuple[Tensor, Tensor, Tensor],
) -> tuple[Tensor, Tensor]:
    """Return light and distance of what is nearest, after one more panel with its shade, stripes and contrast."""
    reach, left, up = _cut(rays, where, turn, panel)
    shade, stripes, contrast = print_of
    plain, across, upwards, strong = (part[:, None, None] for part in (shade, *stripes.unbind(-1), contrast))
    printed = plain * (1.0 + strong * torch.sin(across * left + upwards * up))
    light = torch.where(reach < nearest, printed, light)
    return light, torch.minimum(nearest, reach)


def _turned(matrices: Tensor, rays: Tensor) -> list[Tensor]:
    """Return x, y and z of rays ([batch], exposures, 3, rays) after turns (batch, exposures, 3, 3).

    Written out, since a product of so small matrices would be a pass over memory of its own.
    """
    x, y, z = rays.unbind(-2)
    rows = [row.unbind(-2) for row in matrices[..., None].unbind(-3)]
    return [row[0] * x + row[1] * y + row[2] * z for row in rows]


def _surroundings(
    rays: Tensor, where: Tensor, turn: Tensor, contrast: Tensor, ground: Tensor, shade: Tensor, waves: Tensor
) -> Tensor:
    """Return the light of ground and wall, (batch, exposures, rays); none where the lens draws nothing."""
    x, y, z = _turned(turn, rays)
    height = (where[..., 2] - ground[:, None])[..., None]
    reach = height / (-z).clamp(min=1e-3)
    places = [where[..., 0, None] + reach * x, where[..., 1, None] + reach * y]
    fades = _FADES / (_FADES + reach)
    on_ground = fades * _texture(places, waves[:, 0])
    on_wall = _texture([x, y, z], waves[:, 1])
    below = z < 0
    texture = torch.where(below, on_ground, on_wall)
    plain = torch.where(below, shade[:, 0, None, None], shade[:, 1, None, None])
    return (x * x + y * y + z * z > 0) * plain * (1.0 + contrast[:, None, None] * texture)


def _texture(places: list[Tensor], waves: Tensor) -> Tensor:
    """Return the sum of some waves."""
    total = torch.zeros_like(places[0])
    for number in range(waves.shape[1]):
        wave = waves[:, number, :, None, None]
        phase = wave[:, 3] + sum(wave[:, axis] * place for axis, place in enumerate(places))
        total = total + torch.sin(phase)
    return total


def _blurred(light: Tensor, deviation: Tensor) -> Tensor:
    """Return images blurred by three weights along each side, whose variance is that of a bell."""
    side = 0.5 * (deviation**2).clamp(max=0.66)
    for axis in (-1, -2):
        before, after = (_shifted(light, step, axis) for step in (-1, 1))
        light = (1.0 - 2.0 * side) * light + side * (before + after)
    return light


def _shifted(light: Tensor, step: int, axis: int) -> Tensor:
    """Return images shifted by a pixel, whose last line is repeated."""
    last = light.shape[axis] - 1
    lines = (torch.arange(last + 1, device=light.device) + step).clamp(0, last)
    return light.index_select(axis, lines)
