"""How much each row counts: sensor noise is independent from row to row, what a model lacks is not.

Each channel has the noise of its sensors and beside it, in some blocks, a discrepancy of unknown size: no law holds
exactly, and what no hypothesis knows comes and goes. Sensor noise is independent from row to row. A discrepancy is a
function of the state and repeats where the state does: a recording holds about N_d independent samples of it. With s²
the mean square of a channel's residual in one block, n² that of its noise and R = s²/n², the log likelihood of a block
with n rows is

    noise alone:      ℓ₀ = −½ · n·(R − 1)
    a discrepancy:    ℓ₁ = −½ · [n_d·log R + (n − n_d)·(1 − 1/R)] − c,   n_d = N_d / blocks

where ℓ₁ is the integral over d(−½ log s²) of its independent samples, n_d + (n − n_d)/R, and c is what the unknown size
of the discrepancy costs. A recording is a mixture of both kinds of block, whose share is fitted: where a hypothesis
meets most blocks within the noise, a block that it misses counts against it; where something else is at work
everywhere, only what it explains counts. Source of the tempering: Grünwald & van Ommen 2017, Inconsistency of Bayesian
inference for misspecified linear models (Bayesian Analysis 12).
"""

from dataclasses import dataclass

import torch
from torch import Tensor

from simgap.physics.weak_form import WindowFunctions
from simgap.simulation.blocks import Blocks

_SECONDS = 1.0
"""Time between independent samples of a discrepancy: of thirteen real joints, a second gave the most right answers."""
_FREEDOM = 16.0
"""Degrees of freedom of a discrepancy: it is a smooth function of the state."""
_SHARES = (0.001, 0.01, 0.03, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.97, 0.99, 0.999)
"""Of blocks that hold a discrepancy: from hardly any to nearly all."""
_SPREAD = 1.65
"""What a discrepancy costs a block for its unknown size: the log of four decades of energy, which it may have, over the
1.8 in log s² that four independent rows leave open."""
_LEAST_LASTING = 0.1
"""Of the independent samples of a discrepancy, which remain however much is estimated."""
_OVERLAP = 0.5
"""Share of rows that are independent: windows overlap by half."""


@dataclass(frozen=True)
class Temper:
    """Independent samples in a block of a recording.

    Attributes:
        rows: in a block.
        lasting: independent samples of a discrepancy.
        short: independent samples of the noise beyond those.
        taken: independent samples of the discrepancy that what was estimated has used up.
    """

    rows: int
    lasting: float
    short: float
    taken: float = 0.0

    def value(self, left: Tensor, noise: Tensor) -> Tensor:
        """Return the log likelihood of each channel, (channels,).

        Args:
            left: mean square of the residual in each block, at least the noise's, (blocks, channels).
            noise: mean square of the noise in each block, (blocks, channels) or (channels,).
        """
        spoilt, sound = self._kinds(left / noise)
        _, value = self._share(spoilt, sound)
        return value - 0.5 * self.lasting * noise.log().expand_as(left).sum(0)

    def weight(self, left: Tensor, noise: Tensor) -> Tensor:
        """Return what a row's squared residual counts in it, (blocks, channels): the curvature of the likelihood."""
        ratio = left / noise
        spoilt, sound = self._kinds(ratio)
        share, _ = self._share(spoilt, sound)
        missed = torch.sigmoid(torch.logit(share) + spoilt - sound)
        independent = missed * (self.lasting + self.short / ratio) + (1.0 - missed) * self.total * ratio
        return independent / self.rows / left

    def without(self, levels: float) -> "Temper":
        """Return what is left where so many levels per block were estimated: each takes a sample of the discrepancy."""
        lasting = max(self.lasting - levels, _LEAST_LASTING * self.lasting)
        return Temper(self.rows, lasting, self.total - lasting, self.lasting - lasting)

    @property
    def total(self) -> float:
        """Independent samples of the noise in a block."""
        return self.lasting + self.short

    def _kinds(self, ratio: Tensor) -> tuple[Tensor, Tensor]:
        """Return the log likelihood of each block with a discrepancy and without, (blocks, channels) each."""
        spoilt = -0.5 * (self.lasting * ratio.log() + self.short * (1.0 - 1.0 / ratio))
        return spoilt - _SPREAD, -0.5 * self.total * (ratio - 1.0)

    def _share(self, spoilt: Tensor, sound: Tensor) -> tuple[Tensor, Tensor]:
        """Return the likeliest share of blocks with a discrepancy, and the log likelihood with it, (channels,) each."""
        grid = torch.tensor(_SHARES, dtype=spoilt.dtype)[:, None, None]
        mixed = torch.logaddexp(grid.log() + spoilt, (1.0 - grid).log() + sound).sum(1)
        value, place = mixed.max(0)
        return grid[place, 0, 0], value


def temper_of(blocks: Blocks, functions: WindowFunctions) -> Temper:
    """Return how rows of these blocks count."""
    rows = len(functions.centres)
    seconds = len(blocks) * blocks.samples * blocks.time_step
    lasting = 1.0 / (_SECONDS / seconds + 1.0 / _FREEDOM) / len(blocks)
    lasting = min(lasting, _OVERLAP * rows)
    return Temper(rows, lasting, _OVERLAP * rows - lasting)


def energy_of(residual: Tensor, least: Tensor) -> Tensor:
    """Return the mean square of residuals (blocks, rows, channels) in each block, (blocks, channels), bounded below."""
    return torch.maximum(residual.square().mean(1), least)
