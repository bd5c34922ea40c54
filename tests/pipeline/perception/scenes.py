"""Scenes and images as the tests of perception have them."""

from dataclasses import replace

import numpy as np
import torch
from torch import Tensor

from simgap.gates.track import Track
from simgap.perception.camera import Camera, camera_from
from simgap.perception.pose import Belief
from simgap.perception.render import Motion
from simgap.perception.scene import Scene, scene_around
from simgap.perception.settings import ImageSettings
from tests.pipeline.perception.eyes import fisheye, pinhole_settings

STILL = [0.0, 0.0]
CLEAN = ImageSettings(
    exposures=16, shutter=[0.01, 0.01], blur=STILL, gain=[1.0, 1.0], vignetting=STILL, shot=STILL, read=STILL,
    gate=[1.0, 1.0], clutter=0, covers=0,
)  # fmt: skip
SMALL = 96  # px


def small(lens: str) -> Camera:
    """Return a camera of small images, whose tests are quick."""
    if lens == "fisheye":
        return fisheye(image=[SMALL, SMALL])
    return camera_from(replace(pinhole_settings(), image=[SMALL, 72]))


def gates_at(distances: list[float], height: float = 2.0) -> Track:
    """Return gates across the x axis."""
    centres = torch.tensor([[distance, 0.0, height] for distance in distances])
    axes = torch.eye(3).expand(len(distances), 3, 3)
    return Track(centres, axes, 1.5, 0.3, 0.15, torch.tensor([[-50.0] * 3, [50.0] * 3]))


def dark(track: Track, motion: Motion, settings: ImageSettings = CLEAN, seed: int = 0) -> Scene:
    """Return a scene with no light but that of its panels."""
    random = torch.Generator().manual_seed(seed)
    scene = scene_around(track, motion.position, torch.zeros(len(motion.position)), settings, random)
    return replace(
        scene, contrast=torch.zeros_like(scene.contrast), surroundings=torch.zeros_like(scene.surroundings)
    )


def at(position: list[float], velocity: tuple[float, ...] = (0.0, 0.0, 0.0), pitch: float = 0.0) -> Motion:
    """Return a machine that looks along x, its camera up or down by a pitch, rad."""
    attitude = [np.cos(0.5 * pitch), 0.0, np.sin(0.5 * pitch), 0.0]
    return Motion(
        *(torch.tensor([part], dtype=torch.float32) for part in (position, attitude, velocity, [0.0] * 3))
    )


def standing(machine: Belief) -> Motion:
    """Return a machine at rest."""
    place, attitude = (torch.from_numpy(part).float()[None] for part in (machine.position, machine.attitude))
    return Motion(place, attitude, torch.zeros(1, 3), torch.zeros(1, 3))


def edge_along(profile: Tensor) -> float:
    """Return where a profile that is dark and then light changes, px: where all its light would begin."""
    return len(profile) - 0.5 - float((profile / profile.max()).sum())
