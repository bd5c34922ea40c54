"""How much of the sensors' noise a simulator passes on to rows: what they change by as a little is added.

A fifth difference tells white noise, and an effect that lags behind a noisy signal leaves none of it, though it keeps
the slow part that windows keep, too. So rows are compared with those of a recording that is a little noisier: by so
little that what jumps, such as the teeth of a gear with play, stays where it is.
"""

from dataclasses import replace

import torch
from torch import Tensor

from simgap.equations.derived_noise import shaken_position
from simgap.equations.residuals import residual_rows
from simgap.equations.sample_noise import sample_noise
from simgap.physics.weak_form import WindowFunctions
from simgap.simulation import Simulator
from simgap.simulation.blocks import Blocks
from simgap.simulation.signals import COMMANDS

_SENT = ("motor_command", "position_command")
"""Commands of a program, which hold no noise; of a voltage or an effort only those do that are held."""
_KNOWN = ("elapsed", "run_number", "filled", "heading")
_ADDED = 0.1  # of the noise
_MOST_BLOCKS = 60
_SEED = 0


class PassedNoise:
    """The noise that simulators pass on to the rows of one recording."""

    def __init__(self, blocks: Blocks, functions: WindowFunctions) -> None:
        """Draw the noise, the same for all simulators."""
        self._blocks, self._functions = blocks.thinned(_MOST_BLOCKS), functions
        self._shaken = _shaken(self._blocks)

    def __call__(self, simulator: Simulator) -> Tensor:
        """Return the median square of the added noise in rows, (channels,): some rows change by a jump all the same."""
        quiet, loud = (
            residual_rows(simulator, blocks, self._functions) for blocks in (self._blocks, self._shaken)
        )
        return (loud - quiet).square().flatten(0, 1).median(0).values


def _shaken(blocks: Blocks) -> Blocks:
    """Return blocks whose measured signals hold a little more white noise."""
    if "derived_velocity" in blocks.signals:
        return shaken_position(blocks, _ADDED)
    sent = {*_SENT, *(COMMANDS if blocks.held else ())}
    measured = sorted(n for n in blocks.signals if n not in sent and n not in _KNOWN)
    random = torch.Generator().manual_seed(_SEED)
    loud: dict[str, Tensor] = {}
    for name in measured:
        # A signal may have two names, such as the measured velocity of a chassis: its noise is the same under both.
        twin = next((n for n in loud if torch.equal(blocks.signals[n], blocks.signals[name])), None)
        loud[name] = loud[twin] if twin else _louder(blocks.signals[name], blocks, random)
    return replace(blocks, signals=blocks.signals | loud)


def _louder(series: Tensor, blocks: Blocks, random: torch.Generator) -> Tensor:
    """Return a series (blocks, samples, ...) with a little more of the white noise of each of its components."""
    flat = series.reshape(*series.shape[:2], -1)
    sizes = torch.stack([sample_noise(blocks.inner(each), blocks.noise_kept) for each in flat.unbind(-1)])
    noise = _ADDED * sizes.sqrt() * torch.randn(flat.shape, generator=random, dtype=flat.dtype)
    return series + noise.reshape(series.shape)
