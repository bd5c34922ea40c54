"""How much each row counts: sensor noise is independent from row to row, what a model lacks is not.

Each channel has the noise of its sensors and beside it, in some blocks, a discrepancy of unknown size: no law holds
exactly, and what no hypothesis knows comes and goes. Sensor noise is independent from row to row. A discrepancy is a
function of the state and repeats where the state does: a recording holds about N_d independent samples of it, however
few blocks it is in, and each is seen in many rows. With s² the mean square of a channel's residual in one block, n²
that of its noise, R = s²/n², D the usual mean square of the channel's discrepancy and π the share of blocks that hold
one, the log likelihood of a block with n rows is

    noise alone:      ℓ₀ = k − ½ · n·(R − 1)
    a discrepancy:    ℓ₁ = −½ · n_d·[log(t/n²) + (ν + 1)·log((ν + q/t) / (ν + 1)) + c]

    q = n²·(1 + ρ·(R − 1)),     t = n²·(1 + ρ·√(2/n)) + ρ·D

and that of the noise beside both, −½·(N_d/blocks)·log n². A block that holds a discrepancy has n_d = N_d / (π·blocks)
samples of it, at most one, or N_d / blocks where that is more; and ρ = n / n_d rows for each. k is what noise alone
costs on average: what is less than the noise counts as much, so that it would cost by chance what a discrepancy
without size does not. Rows n are fewer than the independent ones where laws that are not exact add to the noise. A
sample of the discrepancy is the sum of ρ rows over √ρ: noise adds n² to its square, a discrepancy ρ·D, and q is what
was found. By chance the mean square of the noise is off by √(2/n). What noise costs beyond these samples is the same
under all hypotheses. A sample has Student's t with ν degrees of freedom, and c makes its density one: the size of a
discrepancy differs from block to block, rest from acceleration, and yet a block that is met ever better cannot make up
for one that is missed by far more. A recording is a mixture of both kinds of block, whose share and D are fitted; the
prior of the share is exponential. Where a hypothesis meets most blocks within the noise, a block that it misses counts
against it; where something else is at work everywhere, N_d samples count, and not each block that is met.
Sources: Rasmussen & Williams 2006, Gaussian processes for machine learning, eq. 2.30, for the evidence of a function
that is seen through noise, here with N_d equal eigenvalues; Grünwald & van Ommen 2017, Inconsistency of Bayesian
inference for misspecified linear models (Bayesian Analysis 12), for the tempering; Lange, Little & Taylor 1989, Robust
statistical modeling using the t distribution (JASA 84), for t.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from simgap.equations.row_noise import TOLERATED
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
_USUAL_SHARE = 0.2
"""Share of blocks that hold a discrepancy, mean of its exponential prior: equations hold more often than not.

Of 0.05, 0.1, 0.2 and none, it gave the most right names in cases of calibration seeds and in real joints.
"""
_TAIL = 0.8
"""Degrees of freedom ν of a discrepancy's size: its energy is spread over the blocks as if it were anywhere in four
decades, from rest to full acceleration. The logarithm of a Gamma variable of shape ν/2 has that variance (7.1)."""
_SPREAD = (
    2.0 * (math.lgamma(0.5 * _TAIL) - math.lgamma(0.5 * _TAIL + 0.5))
    + math.log(0.5 * _TAIL)
    + (_TAIL + 1.0) * math.log1p(1.0 / _TAIL)
    - 1.0
)
"""What that spread costs a sample: −2·log of the density of t where δ² = t, less that of a Gaussian, c."""
_FIXED_POINTS, _LAST_FIXED_POINTS = 5, 12
"""Iterations for the usual size: to choose a share, and with the chosen one."""
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
        """Return the log likelihood of each channel, (..., channels), with the prior of the share.

        Args:
            left: mean square of the residual in each block, at least the noise's, (..., blocks, channels).
            noise: mean square of the noise in each block, (blocks, channels) or (channels,).
        """
        return self.value_of(self.mixture(left, noise), left, noise)

    def value_of(self, mixture: "Mixture", left: Tensor, noise: Tensor) -> Tensor:
        """Return the log likelihood of each channel under a mixture, (..., channels); see `value`."""
        spoilt, sound = self._beside(left, noise, mixture), self._alone(left, noise)
        blocks = torch.logaddexp(mixture.share.log() + spoilt, (1.0 - mixture.share).log() + sound)
        noises = 0.5 * self.lasting * noise.log()
        return (blocks - noises).sum(-2) - mixture.share.squeeze(-2) / _USUAL_SHARE

    def missed(self, mixture: "Mixture", left: Tensor, noise: Tensor) -> Tensor:
        """Return how probably each block holds a discrepancy under a mixture, (..., blocks, channels); see `value`."""
        spoilt, sound = self._beside(left, noise, mixture), self._alone(left, noise)
        return torch.sigmoid(torch.logit(mixture.share) + spoilt - sound)

    def weight(self, left: Tensor, noise: Tensor) -> Tensor:
        """Return what a row's squared residual counts in it, (blocks, channels): the curvature of the likelihood."""
        return self.weight_of(self.mixture(left, noise), left, noise)

    def weight_of(self, mixture: "Mixture", left: Tensor, noise: Tensor) -> Tensor:
        """Return what a row's squared residual counts under a mixture, (blocks, channels); see `weight`."""
        missed = self.missed(mixture, left, noise)
        repeats = self.total / self.samples(mixture.share)
        seen, expected = self._sample(left, noise, mixture.usual, repeats)
        lasting = (_TAIL + 1.0) / (_TAIL * expected + seen)
        return self.total * (missed * lasting + (1.0 - missed) / noise) / self.rows

    def mixture(self, left: Tensor, noise: Tensor) -> "Mixture":
        """Return the likeliest mixture: of a grid of shares, each with its likeliest usual size of a discrepancy.

        No gradients go through it: where the likelihood is greatest, they are zero.
        """
        from simgap.equations.mixture_steps import likeliest  # its import takes longer than all others here

        noise, shares = noise.detach().expand_as(left), torch.tensor(_SHARES, dtype=torch.float64)
        found = likeliest(
            _by_block(left),
            _by_block(noise),
            _by_block(torch.as_tensor(self.total, dtype=left.dtype).expand_as(left)),
            _by_block(self.by_chance(TOLERATED).to(left.dtype).expand_as(left)),
            shares.numpy(),
            self.samples(shares).numpy(),
            (shares / _USUAL_SHARE).numpy(),
            _TAIL,
            _SPREAD,
            _FIXED_POINTS,
            _LAST_FIXED_POINTS,
        )
        shape = noise.shape[:-2] + noise.shape[-1:]
        return Mixture(*(torch.from_numpy(each).reshape(shape)[..., None, :] for each in found))

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

    def samples(self, share: Tensor) -> Tensor:
        """Return the independent samples of a discrepancy in each block that holds one, of a share of all blocks.

        A discrepancy has as many samples, however few blocks it is in; but hardly more than one in a block.
        """
        return (self.lasting / share).clamp_max(_OF_A_BLOCK).clamp_min(self.lasting)

    def _sample(self, left: Tensor, noise: Tensor, usual: Tensor, repeats: Tensor) -> tuple[Tensor, Tensor]:
        """Return the mean square of what is found of a sample of a discrepancy, and of what is expected, with noise."""
        chance = (2.0 / torch.as_tensor(self.total, dtype=noise.dtype)).sqrt()
        return noise + repeats * (left - noise), noise * (1.0 + repeats * chance) + repeats * usual

    def _alone(self, left: Tensor, noise: Tensor) -> Tensor:
        """Return the log likelihood of each block with noise alone, beyond that of as much noise as is expected."""
        return self.by_chance(TOLERATED) - 0.5 * self.total * (left / noise - 1.0)

    def _beside(self, left: Tensor, noise: Tensor, mixture: "Mixture") -> Tensor:
        """Return the log likelihood of each block with a discrepancy beside the noise; see `_alone`."""
        samples = self.samples(mixture.share)
        seen, expected = self._sample(left, noise, mixture.usual, self.total / samples)
        tail = torch.log1p((seen / expected - 1.0) / (_TAIL + 1.0))
        return -0.5 * samples * ((expected / noise).log() + (_TAIL + 1.0) * tail + _SPREAD)


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
