"""How strongly rows answer to the commands: residuals of an axis are put on the side of its commands.

An equation of motion can be met by making all of its terms small: a dead zone as wide as the commands, next to a small
inertia. What counts is by how much a command would have to differ for the equation to hold, as in a regression of the
commands on the motion. So the rows of a simulator are divided by what commands do to them, relative to the nominal
simulator.
"""

from dataclasses import replace

import torch
from torch import Tensor

from simgap.gap.residuals import rows_of
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
    """The gain of simulators on one set of blocks, relative to that of a nominal simulator."""

    def __init__(self, nominal: Simulator, blocks: Blocks, functions: WindowFunctions) -> None:
        """Work out the gain of the nominal simulator.

        Args:
            nominal: simulator whose rows keep their size.
            blocks: recorded.
            functions: the windows.
        """
        part = torch.linspace(0, len(blocks) - 1, min(len(blocks), _BLOCKS)).round().long()
        self._blocks, self._functions = blocks.take(part), functions
        self._stirred = scaled(self._blocks, 1.0 + _STEP)
        change = self._change(nominal)
        self.commanded = float(change.square().mean())
        self._nominal = float(change.abs().mean())
        self._last = (nominal, 1.0)

    def of(self, simulator: Simulator) -> float:
        """Return the mean size of the change of a simulator's rows per relative change of its commands.

        The mean of sizes is finite where a command decides when a gap is crossed. That of squares would grow without
        bounds as the change of the commands becomes small.
        """
        return float(self._change(simulator).abs().mean())

    def _change(self, simulator: Simulator) -> Tensor:
        rows, stirred = (
            rows_of(simulator, blocks, self._functions) for blocks in (self._blocks, self._stirred)
        )
        return (stirred - rows) / _STEP

    def factor(self, simulator: Simulator) -> float:
        """Return the factor of a simulator's rows that puts them on the side of the commands.

        1 for the nominal simulator, and for every one where no command moves the nominal one.
        """
        if self._nominal == 0.0:
            return 1.0
        if simulator is not self._last[0]:
            gain = max(self.of(simulator), _LEAST * self._nominal)
            self._last = (simulator, self._nominal / gain)
        return self._last[1]


def scaled(blocks: Blocks, factor: float) -> Blocks:
    """Return blocks with their commands times a factor."""
    signals, held = (
        {name: factor * series if name in COMMANDS else series for name, series in part.items()}
        for part in (blocks.signals, blocks.held_commands)
    )
    return replace(blocks, signals=signals, held_commands=held)
