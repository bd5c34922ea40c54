"""How strongly rows answer to the commands: residuals of an axis are put on the side of its commands.

An equation of motion can be met by making all of its terms small: a dead zone as wide as the commands, next to a small
inertia. What counts is by how much a command would have to differ for the equation to hold, as in a regression of the
commands on the motion. So the rows of a simulator are divided by what commands do to them, relative to the nominal
simulator.
"""

from dataclasses import replace

import torch
from torch import Tensor

from simgap.gap.residuals import bare_rows, row_weights, signals_inside, without_lost
from simgap.physics.weak_form import WindowFunctions
from simgap.simulation import Simulator
from simgap.simulation.blocks import Blocks
from simgap.simulation.signals import COMMANDS

_STEP = 0.05
"""Of the commands: small beside them, and large enough that some gap is crossed later."""
_BLOCKS = 60
"""Blocks, drawn evenly, that a gain is the mean of: a ratio of two such means is known to some percent."""
_LEAST = 1e-6
"""Of the nominal gain: a simulator that no command reaches has none."""


class CommandGain:
    """Rows of simulators on one set of blocks, and their gains relative to that of a nominal simulator."""

    def __init__(self, nominal: Simulator, blocks: Blocks, functions: WindowFunctions) -> None:
        """Work out the gain of the nominal simulator.

        Args:
            nominal: simulator whose rows keep their size.
            blocks: recorded.
            functions: the windows.
        """
        self._part = torch.linspace(0, len(blocks) - 1, min(len(blocks), _BLOCKS)).round().long()
        self._blocks, self._functions = blocks, functions
        self._joined = _joined(blocks, scaled(blocks.take(self._part), 1.0 + _STEP))
        self._sound = without_lost(self._joined.take(self._part), functions)
        _, change = self._evaluated(nominal)
        self.commanded = float(change.square().mean())
        self._nominal = float(change.abs().mean())

    def rows(self, simulator: Simulator) -> Tensor:
        """Return the residual of a simulator on the side of its commands, (blocks, rows, channels)."""
        rows, change = self._evaluated(simulator)
        return rows * self._factor(change)

    def factor(self, simulator: Simulator) -> float:
        """Return the factor of a simulator's rows that puts them on the side of the commands.

        1 for the nominal simulator, and for every one where no command moves the nominal one.
        """
        return self._factor(self._evaluated(simulator)[1])

    def _factor(self, change: Tensor) -> float:
        """Return the nominal gain over that of a simulator whose rows change so.

        A gain is the mean size of the change. That is finite where a command decides when a gap is crossed. The mean
        square would grow without bounds as the change of the commands becomes small.
        """
        if self._nominal == 0.0:
            return 1.0
        return self._nominal / max(float(change.abs().mean()), _LEAST * self._nominal)

    def _evaluated(self, simulator: Simulator) -> tuple[Tensor, Tensor]:
        """Return the rows, and for some blocks their change per relative change of the commands, in one evaluation."""
        joined, count = self._joined, len(self._blocks)
        inner = signals_inside(simulator, joined, joined.acting)
        bare = bare_rows(simulator, joined, self._functions, inner)
        change = (bare[count:] - bare[self._part]) * self._sound / _STEP
        recorded = {name: series[:count] for name, series in inner.items()}
        return bare[:count] * row_weights(simulator, recorded, self._blocks, self._functions), change


def _joined(first: Blocks, second: Blocks) -> Blocks:
    """Return two sets of blocks as one."""
    signals, held, resolution = (
        {
            name: torch.cat([series, getattr(second, part)[name]])
            for name, series in getattr(first, part).items()
        }
        for part in ("signals", "held_commands", "resolution")
    )
    return replace(
        first,
        signals=signals,
        held_commands=held,
        resolution=resolution,
        run=torch.cat([first.run, second.run]),
        start=torch.cat([first.start, second.start]),
    )


def scaled(blocks: Blocks, factor: float) -> Blocks:
    """Return blocks with their commands times a factor."""
    signals, held = (
        {name: factor * series if name in COMMANDS else series for name, series in part.items()}
        for part in (blocks.signals, blocks.held_commands)
    )
    return replace(blocks, signals=signals, held_commands=held)
