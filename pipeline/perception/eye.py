"""A camera with a detector behind it: the images that machines see of a track, and the gates that are found in them."""

from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from simgap.gates.track import Track
from simgap.perception.camera import camera_from
from simgap.perception.corners import gates_in
from simgap.perception.detector import Detector, Maps, check_size
from simgap.perception.render import Motion, Renderer
from simgap.perception.scene import Scene, scene_around
from simgap.perception.settings import PerceptionSettings

Array = NDArray[Any]


class Eye:
    """Renders images and reads them."""

    def __init__(self, network: Detector, settings: PerceptionSettings, device: str) -> None:
        """Bring both to a device.

        Args:
            network: that finds corners.
            settings: of camera, images, and how corners are read off the maps.
            device: where images are drawn and read.

        Raises:
            InputError: on a camera that cannot be, and on images that the network cannot halve.
        """
        self.settings, self.device = settings, device
        self.camera = camera_from(settings.camera)
        check_size(self.camera.size, settings.detector)
        self.maps = Maps(network).eval().to(device)
        self.renderer = Renderer(self.camera, settings.images, device)

    def scene(self, track: Track, position: torch.Tensor, random: torch.Generator) -> Scene:
        """Return a track among random panels, over ground at the bottom of its box, for each place (batch, 3) m."""
        ground = torch.full((len(position),), float(track.box[0, 2]), device=self.device)
        return scene_around(track, position, ground, self.settings.images, random)

    @torch.no_grad()
    def found(self, images: torch.Tensor) -> list[Array]:
        """Return the corners of the gates of each image (batch, 1, height, width): (gates, 4, 2) px each."""
        return gates_in(self.maps(images), self.camera, self.settings.detector)


class Eyes:
    """The eyes of machines that fly in a world which stands still, a world for each of them.

    Attributes:
        images: the last ones, (machines, 1, height, width), from 0 to 1.
    """

    def __init__(self, eye: Eye, track: Track, seed: int) -> None:
        """Look at nothing yet.

        Args:
            eye: of each machine.
            track: its gates.
            seed: of the worlds, and of the noise of images.
        """
        self._eye, self._track = eye, track
        self._random = torch.Generator(eye.device).manual_seed(seed)
        self._scene: Scene | None = None
        self.images = torch.empty(0)

    def __call__(self, states: Array) -> list[Array]:
        """Return the corners of the gates that each machine finds in a new image, (gates, 4, 2) px each.

        Args:
            states: position, velocity (world), attitude, body rate, (machines, 13).
        """
        motion = motion_of(states, self._eye.device)
        if self._scene is None:
            self._scene = self._eye.scene(self._track, motion.position, self._random)
        self.images = self._eye.renderer.images(self._scene, motion, self._random)
        return self._eye.found(self.images)


def motion_of(states: Array, device: str) -> Motion:
    """Return how machines move whose states (machines, 13) are position, velocity, attitude and body rate."""
    position, velocity, attitude, rate = (
        torch.from_numpy(np.ascontiguousarray(part)).float().to(device)
        for part in np.split(states, [3, 6, 10], axis=1)
    )
    return Motion(position, attitude, velocity, rate)
