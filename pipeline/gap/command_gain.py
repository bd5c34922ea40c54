"""How strongly rows answer to the commands: residuals are put on the side of the commands.

An equation of motion can be met by making all of its terms small: a dead zone as wide as the commands next to a small
inertia, or a great inertia where rotor speeds are noisy. What counts is by how much a command would have to differ for
the equation to hold, as in a regression of the commands on the motion. So the rows of a channel are divided by what
commands do to them, relative to the nominal simulator.
"""

from collections import OrderedDict
from dataclasses import replace

import torch
from torch import Tensor

from simgap.gap.residuals import bare_rows, channel_series, row_weights, signals_inside, without_lost
from simgap.physics.weak_form import WindowFunctions, mean_rate_of
from simgap.simulation import Simulator
from simgap.simulation.blocks import Blocks
from simgap.simulation.signals import COMMANDS

_BLOCKS = 60
"""Blocks, drawn evenly, that a gain is the mean of: a ratio of two such means is known to some percent."""
_LEAST = 1e-6
"""Of the nominal gain: a simulator that no command reaches has none."""
_KEPT = 8
"""Simulators whose rows are kept: a step of a fit asks for those of one several times."""


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
        some = blocks.take(self._part)
        self._joined = _joined(blocks, _without_commands(some))
        self._sound = without_lost(some, functions)
        self._kept: OrderedDict[tuple[object, ...], tuple[Tensor, Tensor, Tensor]] = OrderedDict()
        self._moved = _moved(nominal, some, functions).square().mean((0, 1))
        _, commanded, _ = self._evaluated(nominal)
        self._commanded, self._nominal = commanded.square().mean((0, 1)), commanded.abs().mean((0, 1))

    def rows(self, simulator: Simulator) -> Tensor:
        """Return the residual of a simulator on the side of its commands, (blocks, rows, channels)."""
        rows, commanded, _ = self._evaluated(simulator)
        return rows * self._factor(commanded)

    def factor(self, simulator: Simulator) -> Tensor:
        """Return the factors of a simulator's rows that put them on the side of the commands, (channels,).

        1 for the nominal simulator, and for every one where no command moves the nominal one.
        """
        return self._factor(self._evaluated(simulator)[1])

    def smaller_side(self, simulator: Simulator) -> Tensor:
        """Return the mean square of the smaller side of an equation, on the side of the commands, (channels,).

        One side is what commands do in the nominal simulator, the other what is left of a simulator without commands
        beside the recorded rate of momentum. Where commands act in few rows only, their mean does not show it.
        """
        _, commanded, still = self._evaluated(simulator)
        rest = still.square().mean((0, 1)) * self._factor(commanded) ** 2 + self._moved
        return torch.where(self._nominal > 0.0, torch.minimum(rest, self._commanded), rest)

    def _factor(self, commanded: Tensor) -> Tensor:
        """Return the nominal gain over that of a simulator, (channels,): the mean size of what commands do to rows."""
        moved = self._nominal > 0.0
        gain = torch.maximum(commanded.abs().mean((0, 1)), _LEAST * self._nominal)
        return torch.where(moved, self._nominal, 1.0) / torch.where(moved, gain, 1.0)

    def _evaluated(self, simulator: Simulator) -> tuple[Tensor, Tensor, Tensor]:
        """Return all rows, and of some blocks what commands do to them, and what they are without."""
        values = tuple((each.effect, *each.values.values()) for each in simulator.effects)
        if values not in self._kept:
            self._kept[values] = self._evaluate(simulator)
        if len(self._kept) > _KEPT:
            self._kept.popitem(last=False)
        return self._kept[values]

    def _evaluate(self, simulator: Simulator) -> tuple[Tensor, Tensor, Tensor]:
        joined, count = self._joined, len(self._blocks)
        inner = signals_inside(simulator, joined, joined.acting)
        bare = bare_rows(simulator, joined, self._functions, inner)
        still = bare[count:] * self._sound
        commanded = bare[self._part] * self._sound - still
        recorded = {name: series[:count] for name, series in inner.items()}
        rows = bare[:count] * row_weights(simulator, recorded, self._blocks, self._functions)
        return rows, commanded, still


def _without_commands(blocks: Blocks) -> Blocks:
    """Return blocks with commands that ask for nothing: none, or a servo's own position."""
    silent = {name: torch.zeros_like(series) for name, series in blocks.signals.items() if name in COMMANDS}
    if "position_command" in silent:
        silent["position_command"] = blocks.signals["position"]
    held = {name: silent[name] for name in blocks.held_commands}
    return replace(blocks, signals={**blocks.signals, **silent}, held_commands=held)


def _moved(nominal: Simulator, blocks: Blocks, functions: WindowFunctions) -> Tensor:
    """Return the recorded rate of each channel's momentum, (blocks, rows, channels)."""
    series = channel_series(nominal, blocks)
    return torch.stack([mean_rate_of(functions, each.measured, blocks.held) for each in series], dim=-1)


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
