"""How much each row counts: sensor noise is independent from row to row, what a model lacks is not.

Each channel has the noise of its sensors and beside it, in some blocks, a discrepancy of unknown size: no law holds
exactly, and what no hypothesis knows comes and goes. Sensor noise is independent from row to row. A discrepancy is a
function of the state and repeats where the state does: a recording holds about N_d independent samples of it. With s²
the mean square of a channel's residual in one block, n² that of its noise, R = s²/n² and D the usual mean square of the
channel's discrepancy, the log likelihood of a block with n rows is

    noise alone:      ℓ₀ = −½ · [n·(R − 1) + n_d·log n²]
    a discrepancy:    ℓ₁ = −½ · [n_d·(log D + (ν + 1)·log((ν + s²/D) / (ν + 1))) + (n − n_d)·(1 − 1/R)] − c

with n_d = N_d / blocks, and n fewer than the independent rows where laws that are not exact add to the noise. The
discrepancy has Student's t with ν degrees of freedom: its size differs from block to block, rest from acceleration, and
yet a block that is met ever better cannot make up for one that is missed by far more. What is left of the noise counts
1/R. A recording is a mixture of both kinds of block, whose share and D are fitted: where a hypothesis meets most blocks
within the noise, a block that it misses counts against it; where something else is at work everywhere, only what it
explains counts. Sources: Grünwald & van Ommen 2017, Inconsistency of Bayesian inference for misspecified linear models
(Bayesian Analysis 12), for the tempering; Lange, Little & Taylor 1989, Robust statistical modeling using the t
distribution (JASA 84), for t and its fixed point.
"""

from dataclasses import dataclass, replace

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from simgap.physics.weak_form import WindowFunctions
from simgap.simulation.blocks import Blocks

WIDTHS = 5.0
"""Widths of a window between independent samples of a discrepancy: of thirteen real joints, whose windows are 0.2 s
wide, a second gave the most right answers. Windows are as wide as the motion is slow, and so is what repeats with it.
"""
_FREEDOM = 16.0
"""Degrees of freedom of a discrepancy: it is a smooth function of the state."""
_SHARES = (0.001, 0.01, 0.05, 0.2, 0.4, 0.6, 0.8, 0.95, 0.99, 0.999)
"""Of blocks that hold a discrepancy: from hardly any to nearly all."""
_TAIL = 4.0
"""Degrees of freedom ν of a discrepancy's size: Lange, Little & Taylor find 4 right for real data."""
_FIXED_POINTS, _LAST_FIXED_POINTS = 5, 12
"""Iterations for the usual size: to choose a share, and with the chosen one."""
_SPREAD = 1.65
"""What a discrepancy costs a block for its unknown size: the log of four decades of energy, which it may have, over the
1.8 in log s² that four independent rows leave open."""
_LEAST_LASTING = 0.1
"""Of the independent samples of a discrepancy, which remain however much is estimated."""
_OF_A_BLOCK = 1.0
"""Degrees of freedom that the mean square of one block has at least, however long what makes it lasts."""
_OVERLAP = 0.5
"""Share of rows that are independent: windows overlap by half."""


@dataclass(frozen=True)
class Temper:
    """Independent samples in a block of a recording.

    Attributes:
        rows: in a block.
        lasting: independent samples of a discrepancy.
        short: independent samples of the noise beyond those; a number, or one for each block and channel.
        taken: independent samples of the discrepancy that what was estimated has used up.
    """

    rows: int
    lasting: float
    short: float | Tensor
    taken: float = 0.0

    def value(self, left: Tensor, noise: Tensor) -> Tensor:
        """Return the log likelihood of each channel, (..., channels).

        Args:
            left: mean square of the residual in each block, at least the noise's, (..., blocks, channels).
            noise: mean square of the noise in each block, (blocks, channels) or (channels,).
        """
        return self.value_of(self.mixture(left, noise), left, noise)

    def value_of(self, mixture: "Mixture", left: Tensor, noise: Tensor) -> Tensor:
        """Return the log likelihood of each channel under a mixture, (..., channels); see `value`."""
        sound, beyond = self._kinds(left, noise)
        spoilt, share = beyond + self._size(left, mixture.usual), mixture.share
        return torch.logaddexp(share.log() + spoilt, (1.0 - share).log() + sound).sum(-2)

    def weight(self, left: Tensor, noise: Tensor) -> Tensor:
        """Return what a row's squared residual counts in it, (blocks, channels): the curvature of the likelihood."""
        return self.weight_of(self.mixture(left, noise), left, noise)

    def weight_of(self, mixture: "Mixture", left: Tensor, noise: Tensor) -> Tensor:
        """Return what a row's squared residual counts under a mixture, (blocks, channels); see `weight`."""
        sound, beyond = self._kinds(left, noise)
        missed = torch.sigmoid(torch.logit(mixture.share) + beyond + self._size(left, mixture.usual) - sound)
        ratio, relative = left / noise, left / mixture.usual
        lasting = self.lasting * (_TAIL + 1.0) * relative / (_TAIL + relative)
        independent = missed * (lasting + self.short / ratio) + (1.0 - missed) * self.total * ratio
        return independent / self.rows / left

    def mixture(self, left: Tensor, noise: Tensor) -> "Mixture":
        """Return the likeliest mixture: of a grid of shares, each with its likeliest usual size of a discrepancy.

        No gradients go through it: where the likelihood is greatest, they are zero.
        """
        from simgap.equations.mixture_steps import likeliest  # its import takes longer than all others here

        sound, beyond = self._kinds(left, noise)
        least = noise.detach().expand_as(left).amin(-2)
        found = likeliest(
            _by_block(left),
            _by_block(beyond.expand_as(left)),
            _by_block(sound),
            least.flatten().numpy(),
            self.lasting,
            _TAIL,
            np.array(_SHARES),
            _FIXED_POINTS,
            _LAST_FIXED_POINTS,
        )
        return Mixture(*(torch.from_numpy(each).reshape(least.shape)[..., None, :] for each in found))

    def by_chance(self, tolerated: float) -> Tensor:
        """Return what noise alone costs a block on average, in log likelihood: its mean square is too high at times.

        Args:
            tolerated: mean square over the noise's that costs nothing.
        """
        freedom = torch.as_tensor(self.total, dtype=torch.float64)
        above = torch.special.gammaincc(0.5 * freedom + 1.0, 0.5 * freedom * tolerated)
        missed = above - tolerated * torch.special.gammaincc(0.5 * freedom, 0.5 * freedom * tolerated)
        return 0.5 * freedom * missed / tolerated

    def without(self, levels: float) -> "Temper":
        """Return what is left where so many levels per block were estimated: each takes a sample of the discrepancy."""
        lasting = max(self.lasting - levels, _LEAST_LASTING * self.lasting)
        return Temper(self.rows, lasting, self.total - lasting, self.lasting - lasting)

    def beside(self, noise: Tensor, inexact: Tensor) -> "Temper":
        """Return how rows count where what no law is exact to adds to their noise: it lasts as a discrepancy does.

        Of a sum of two mean squares with their own numbers of independent samples, Satterthwaite's number counts.
        Source: Satterthwaite 1946, An approximate distribution of estimates of variance components (Biometrics
        Bulletin 2), eq. 17.

        Args:
            noise: mean square of the noise of the sensors, (blocks, channels) or (channels,).
            inexact: mean square of what no law is exact to, (blocks, channels).
        """
        lasting = max(self.lasting, _OF_A_BLOCK)
        independent = (noise + inexact).square() / (noise.square() / self.total + inexact.square() / lasting)
        return replace(self, short=(independent - self.lasting).clamp_min(0.0))

    def of_blocks(self, part: list[int]) -> "Temper":
        """Return how rows of some blocks count."""
        return replace(self, short=self.short[part]) if isinstance(self.short, Tensor) else self

    @property
    def total(self) -> float | Tensor:
        """Independent samples of the noise in a block."""
        return self.lasting + self.short

    def _kinds(self, left: Tensor, noise: Tensor) -> tuple[Tensor, Tensor]:
        """Return the log likelihood of each block with noise alone, and what it is beside a discrepancy."""
        ratio = left / noise
        sound = -0.5 * (self.total * (ratio - 1.0) + self.lasting * noise.log())
        return sound, -0.5 * self.short * (1.0 - 1.0 / ratio) - _SPREAD

    def _size(self, left: Tensor, usual: Tensor) -> Tensor:
        """Return the log likelihood of the independent samples of a discrepancy of a usual mean square."""
        return (
            -0.5
            * self.lasting
            * (usual.log() + (_TAIL + 1.0) * torch.log1p((left / usual - 1.0) / (_TAIL + 1.0)))
        )


@dataclass(frozen=True)
class Mixture:
    """How the blocks of each channel divide.

    Attributes:
        share: of blocks that hold a discrepancy, (..., 1, channels).
        usual: mean square of a discrepancy, (..., 1, channels).
    """

    share: Tensor
    usual: Tensor


def _by_block(series: Tensor) -> NDArray[np.float64]:
    """Return a series (..., blocks, channels) as rows of blocks, (... · channels, blocks)."""
    return series.detach().transpose(-1, -2).contiguous().flatten(0, -2).numpy()


def temper_of(blocks: Blocks, functions: WindowFunctions, width: float) -> Temper:
    """Return how rows of these blocks count, for windows of a width in s."""
    rows = len(functions.centres)
    seconds = len(blocks) * blocks.samples * blocks.time_step
    lasting = 1.0 / (WIDTHS * width / seconds + 1.0 / _FREEDOM) / len(blocks)
    lasting = min(lasting, _OVERLAP * rows)
    return Temper(rows, lasting, _OVERLAP * rows - lasting)


def energy_of(residual: Tensor, least: Tensor) -> Tensor:
    """Return the mean square of residuals (blocks, rows, channels) in each block, (blocks, channels), bounded below."""
    return torch.maximum(residual.square().mean(1), least)
