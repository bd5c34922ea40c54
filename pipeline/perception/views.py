"""Random views of gates, from which a detector learns; no track of the project is among them."""

import math

import torch
from torch import Tensor

from simgap.gates.track import Track
from simgap.perception.camera import Camera
from simgap.perception.render import Motion
from simgap.perception.scene import uniform
from simgap.perception.settings import ViewSettings
from simgap.physics import rotations


def random_views(
    camera: Camera, settings: ViewSettings, batch: int, random: torch.Generator
) -> tuple[Track, Motion, Tensor]:
    """Return gates around a machine that moves at will, for each image.

    Args:
        camera: on the machine.
        settings: of the views.
        batch: images.
        random: on the device where they are wanted.

    Returns:
        Tracks, one for each image; motion; height of the ground, (batch,) m.
    """
    attitude = _attitudes(settings, batch, random)
    motion = Motion(
        torch.zeros(batch, 3, device=random.device),
        attitude,
        uniform([0.0, settings.speed], (batch, 1), random) * _directions(batch, random),
        settings.rate * torch.randn(batch, 3, generator=random, device=random.device),
    )
    sight = _in_cone(settings, batch, random)
    away = rotations.rotate(attitude[:, None], sight @ camera.axes.to(sight))
    logarithms = [math.log(end) for end in settings.distance]
    centres = uniform(logarithms, (batch, settings.gates, 1), random).exp() * away
    axes = _axes(centres, settings, random)
    half = 0.5 * settings.opening + settings.frame
    lowest = torch.minimum(centres[..., 2].min(-1).values - half, centres.new_tensor(-0.3))
    box = torch.tensor([[-math.inf] * 3, [math.inf] * 3], device=random.device)
    track = Track(centres, axes, settings.opening, settings.frame, 0.0, box)
    return track, motion, lowest - uniform([0.0, 2.0], (batch,), random)


def _attitudes(settings: ViewSettings, batch: int, random: torch.Generator) -> Tensor:
    """Return a tilt to any side, after a turn by any angle about the vertical."""
    zero = torch.zeros(batch, device=random.device)
    yaw, side = uniform([-math.pi, math.pi], (2, batch), random)
    tilt = settings.tilt * torch.randn(batch, generator=random, device=random.device)
    turn = rotations.from_rotation_vector(torch.stack((zero, zero, yaw), dim=-1))
    lean = rotations.from_rotation_vector(torch.stack((tilt * side.cos(), tilt * side.sin(), zero), dim=-1))
    return rotations.multiply(turn, lean)


def _directions(batch: int, random: torch.Generator) -> Tensor:
    towards = torch.randn(batch, 3, generator=random, device=random.device)
    return torch.nn.functional.normalize(towards, dim=-1)


def _in_cone(settings: ViewSettings, batch: int, random: torch.Generator) -> Tensor:
    """Return directions around the camera's axis in its frame, spread evenly over their angle to it."""
    shape = (batch, settings.gates)
    angle = uniform([0.0, settings.aside], shape, random)
    around = uniform([-math.pi, math.pi], shape, random)
    return torch.stack((angle.sin() * around.cos(), angle.sin() * around.sin(), angle.cos()), dim=-1)


def _axes(centres: Tensor, settings: ViewSettings, random: torch.Generator) -> Tensor:
    """Return axes of upright gates, which are seen askew, and half of them from behind."""
    shape = centres.shape[:2]
    behind = (torch.rand(shape, generator=random, device=random.device) < 0.5) * math.pi
    askew = uniform([-settings.askew, settings.askew], shape, random)
    yaw = torch.atan2(centres[..., 1], centres[..., 0]) + behind + askew
    x, y, zero, one = yaw.cos(), yaw.sin(), torch.zeros_like(yaw), torch.ones_like(yaw)
    rows = [torch.stack(row, dim=-1) for row in ((x, y, zero), (-y, x, zero), (zero, zero, one))]
    return torch.stack(rows, dim=-2)
