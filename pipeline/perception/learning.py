"""Training of a gate detector with PyTorch Lightning, on images that are drawn as they are needed."""

import math
from functools import partial
from typing import Any

import pytorch_lightning as lightning
import torch
from torch import Tensor, nn

from simgap.perception.camera import camera_from
from simgap.perception.detector import Detector, check_size
from simgap.perception.maps import CORNERS, targets
from simgap.perception.render import Renderer, unhidden
from simgap.perception.scene import scene_around
from simgap.perception.settings import DetectorSettings, PerceptionSettings
from simgap.perception.view import view
from simgap.perception.views import random_views

_RISING = 0.05  # share of the steps in which the learning rate rises
VALIDATION_LOSS = "validation_loss"
_FAR = 2**32  # seeds of validation begin there


class Learning(lightning.LightningModule):
    """A detector and the images that it learns from: those of a step depend on seed and step alone."""

    def __init__(self, network: Detector, settings: PerceptionSettings, seed: int) -> None:
        """Check that the images fit.

        Raises:
            InputError: on a camera that cannot be, and on images that the network cannot halve.
        """
        super().__init__()
        self.network, self.settings, self.seed = network, settings, seed
        self.learning = settings.detector.learning
        self.camera = camera_from(settings.camera)
        check_size(self.camera.size, settings.detector)

    def on_fit_start(self) -> None:
        """Make the renderer where the network is."""
        self.renderer = Renderer(self.camera, self.settings.images, self.device)
        self.network.to(memory_format=torch.channels_last)  # type: ignore[call-overload]

    def train_dataloader(self) -> range:
        """Return the numbers of an epoch's steps."""
        steps = self.learning.steps
        return range(self.current_epoch * steps, (self.current_epoch + 1) * steps)

    def val_dataloader(self) -> range:
        """Return numbers that are always the same."""
        return range(_FAR, _FAR + self.learning.validation)

    def training_step(self, number: int, index: int) -> Tensor:
        """Return the loss of a batch."""
        loss = self.loss(*self.examples(number))
        self.log("train_loss", loss, on_step=False, on_epoch=True, batch_size=self.learning.batch)
        return loss

    def validation_step(self, number: int, index: int) -> None:
        """Log the loss of a batch."""
        self.log(
            VALIDATION_LOSS, self.loss(*self.examples(number)), on_epoch=True, batch_size=self.learning.batch
        )

    def configure_optimizers(self) -> Any:
        """Return Adam, whose rate rises in the first twentieth and falls along a cosine."""
        optimizer = torch.optim.Adam(self.parameters(), lr=self.learning.learning_rate)
        rate = partial(_rate, steps=self.learning.epochs * self.learning.steps)
        schedule = torch.optim.lr_scheduler.LambdaLR(optimizer, rate)
        return {"optimizer": optimizer, "lr_scheduler": {"scheduler": schedule, "interval": "step"}}

    def loss(self, images: Tensor, wanted: Tensor) -> Tensor:
        """Return the loss of images; on a GPU, the network's products are in half precision."""
        with torch.autocast(self.device.type, torch.bfloat16, enabled=self.device.type == "cuda"):
            found = self.network(images.to(memory_format=torch.channels_last))
        return loss_of(found.float(), wanted, self.settings.detector)

    @torch.inference_mode(False)
    @torch.no_grad()
    def examples(self, number: int) -> tuple[Tensor, Tensor]:
        """Return the images of a step, and what is to be found in them."""
        device, detector = self.renderer.device, self.settings.detector
        random = torch.Generator(device).manual_seed((self.seed * 1_000_003 + number) % 2**63)
        track, motion, ground = random_views(self.camera, detector.views, self.learning.batch, random)
        scene = scene_around(track, motion.position, ground, self.settings.images, random)
        seen = view(self.camera, track, motion.position, motion.attitude)
        shown = unhidden(scene, motion, self.camera, seen)
        return self.renderer.images(scene, motion, random), targets(self.camera, seen, shown, detector)


def _rate(step: int, steps: int) -> float:
    """Return the share of the greatest learning rate."""
    share = (step + 1) / (steps + 1)
    return min(1.0, share / _RISING) * 0.5 * (1.0 + math.cos(math.pi * share))


def loss_of(found: Tensor, wanted: Tensor, settings: DetectorSettings) -> Tensor:
    """Return cross-entropy of the maps and squared error of the fields.

    Pixels of corners and edges are few. They weigh more than others, which moves no optimum.
    """
    learning = settings.learning
    maps, fields = found[:, :CORNERS], found[:, CORNERS:]
    wanted_maps, wanted_fields = wanted[:, :CORNERS], wanted[:, CORNERS:]
    entropy = nn.functional.binary_cross_entropy_with_logits(
        maps, wanted_maps, 1.0 + learning.corner * wanted_maps
    )
    length = wanted_fields.unflatten(1, (-1, 2)).square().sum(2, keepdim=True)
    rare = (1.0 + learning.edge * length).expand(-1, -1, 2, -1, -1).flatten(1, 2)
    return entropy + (rare * (fields - wanted_fields).square()).mean()
