"""The gate detector: a U-Net of six levels, whose last layer gives twelve maps of an image.

Kaufmann et al. 2023 (Nature 620, Methods) name the filters and their sizes, LeakyReLU and the last layer of twelve
filters. Here these twelve are the output: four maps of corners and eight components of fields
(`simgap.perception.maps`). A level has two convolutions on the way down and two on the way up, as in Ronneberger et al.
2015 (MICCAI).
"""

import math
from collections.abc import Sequence

import torch
from jaxtyping import Float
from torch import Tensor, nn

from simgap.errors import InputError
from simgap.perception.maps import CHANNELS, CORNERS
from simgap.perception.settings import DetectorSettings

_RARE = 0.01  # share of pixels that a network takes for corners before it has learned
_WHERE = "perception.detector"


class Detector(nn.Module):
    """From grey images to maps of corners, as logarithms of odds, and fields of edges."""

    def __init__(self, settings: DetectorSettings) -> None:
        """Build the levels.

        Raises:
            InputError: when filters and kernels are not of as many levels, or a kernel has no middle.
        """
        super().__init__()
        filters, kernels = settings.filters, settings.kernels
        if not filters or len(filters) != len(kernels):
            raise InputError("needs one size for each level", f"{_WHERE}.kernels", "give as many as filters")
        if any(kernel % 2 == 0 for kernel in kernels):
            raise InputError("a filter has no middle pixel", f"{_WHERE}.kernels", "use odd numbers")
        levels = list(zip([1, *filters], filters, kernels, strict=False))
        self.down = nn.ModuleList(_level(*level, settings.slope) for level in levels)
        self.up = nn.ModuleList(
            _level(above + below, above, kernel, settings.slope)
            for above, below, kernel in zip(filters, filters[1:], kernels, strict=False)
        )
        self.last = nn.Conv2d(filters[0], CHANNELS, kernels[0], padding=kernels[0] // 2)
        nn.init.constant_(self.last.get_parameter("bias")[:CORNERS], math.log(_RARE / (1.0 - _RARE)))

    def forward(
        self, images: Float[Tensor, "batch 1 height width"]
    ) -> Float[Tensor, "batch 12 height width"]:
        """Return what the last layer gives; sides of an image are multiples of 2 to the number of levels less one."""
        kept = []
        for number, level in enumerate(self.down):
            images = level(images if number == 0 else nn.functional.max_pool2d(images, 2))
            kept.append(images)
        images = kept.pop()
        for level in reversed(self.up):
            larger = nn.functional.interpolate(images, scale_factor=2.0, mode="nearest")
            images = level(torch.cat((kept.pop(), larger), dim=1))
        return self.last(images)


class Maps(nn.Module):
    """A detector whose maps of corners lie between 0 and 1."""

    def __init__(self, network: Detector) -> None:
        super().__init__()
        self.network = network

    def forward(
        self, images: Float[Tensor, "batch 1 height width"]
    ) -> Float[Tensor, "batch 12 height width"]:
        """Return maps and fields of images."""
        found = self.network(images)
        return torch.cat((torch.sigmoid(found[:, :CORNERS]), found[:, CORNERS:]), dim=1)


def check_size(size: Sequence[int], settings: DetectorSettings) -> None:
    """Refuse images that cannot be halved at every level.

    Raises:
        InputError: on such a size, px.
    """
    factor = 2 ** (len(settings.filters) - 1)
    if any(side % factor for side in size):
        raise InputError(
            f"sides of {size[0]} × {size[1]} cannot be halved at every level of the detector",
            "perception.camera.image",
            f"use multiples of {factor}",
        )


def _level(inputs: int, filters: int, kernel: int, slope: float) -> nn.Sequential:
    layers: list[nn.Module] = []
    for channels in (inputs, filters):
        convolution = nn.Conv2d(channels, filters, kernel, padding=kernel // 2)
        nn.init.kaiming_normal_(convolution.weight, slope)
        layers += [convolution, nn.BatchNorm2d(filters), nn.LeakyReLU(slope)]
    return nn.Sequential(*layers)
