"""How strongly rows answer to the commands: residuals are put on the side of the commands.

An equation of motion can be met by making all of its terms small: a dead zone as wide as the commands next to a small
inertia, or a great inertia where rotor speeds are noisy. What counts is by how much a command would have to differ for
the equation to hold, as in a regression of the commands on the motion. So the rows of a channel are divided by what
commands do to them, relative to the nominal simulator.

What a command does is not the same everywhere: without a voltage, back-EMF brakes, and friction may make much of it.
The gain is therefore the smaller one of two: of what commands do to rows, and of what the actuators' own forces do, of
a motor those at standstill.
"""

from dataclasses import dataclass, replace

import torch
from torch import Tensor

from simgap.effects import Effect, WrenchEffect
from simgap.equations.recent import Recent
from simgap.equations.residuals import Inside, bare_rows, channel_series, row_weights, without_lost
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


@dataclass(frozen=True)
class Answer:
    """How the rows of one simulator answer to its actuators.

    Attributes:
        rows: of all blocks, (blocks, rows, channels).
        commanded: what commands do to those of some blocks, (some blocks, rows, channels).
        exerted: what forces of actuators do to them.
        still: what they are without commands.
    """

    rows: Tensor
    commanded: Tensor
    exerted: Tensor
    still: Tensor


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
        self._some = blocks.take(self._part)
        self._joined = _joined(blocks, _without_commands(self._some))
        self._inside = Inside(self._joined)
        self._sound = without_lost(self._some, functions)
        # What a position loop exerts answers the motion: it is no measure of what the loop is told.
        looped = "position_command" in blocks.signals
        self._exerted = () if looped else nominal.mechanism.exerted
        # Nor is what a motor exerts beside back-EMF: that is small where its voltage is in time with the motion.
        self._stalled = Inside(_at_rest(self._some)) if "voltage" in blocks.signals else None
        self._answers, self._exerted_by = Recent[Answer](_KEPT), Recent[Tensor](_KEPT)
        self._moved = _moved(nominal, self._some, functions).square().mean((0, 1))
        self._nominal = self._evaluated(nominal)

    def rows(self, simulator: Simulator) -> Tensor:
        """Return the residual of a simulator on the side of its commands, (blocks, rows, channels)."""
        answer = self._evaluated(simulator)
        return answer.rows * self._factor(answer)

    def inside(self, simulator: Simulator) -> dict[str, Tensor]:
        """Return the signals in a simulator, see `simgap.equations.residuals.signals_inside`."""
        return {name: series[: len(self._blocks)] for name, series in self._inside(simulator).items()}

    def factor(self, simulator: Simulator) -> Tensor:
        """Return the factors of a simulator's rows that put them on the side of the commands, (channels,).

        1 for the nominal simulator, and for every one where no command moves the nominal one.
        """
        return self._factor(self._evaluated(simulator))

    def smaller_side(self, simulator: Simulator) -> Tensor:
        """Return the mean square of the smaller side of an equation, on the side of the commands, (channels,).

        One side is what commands do in the nominal simulator, the other what is left of a simulator without commands
        beside the recorded rate of momentum. Where commands act in few rows only, their mean does not show it.
        """
        answer = self._evaluated(simulator)
        rest = answer.still.square().mean((0, 1)) * self._factor(answer) ** 2 + self._moved
        commanded = self._nominal.commanded
        return torch.where(
            commanded.any(0).any(0), torch.minimum(rest, commanded.square().mean((0, 1))), rest
        )

    def _factor(self, answer: Answer) -> Tensor:
        """Return the nominal gain over that of a simulator, (channels,)."""
        gain = torch.minimum(
            _relative(answer.commanded, self._nominal.commanded),
            _relative(answer.exerted, self._nominal.exerted),
        )
        return torch.where(gain.isinf(), 1.0, 1.0 / gain)

    def _evaluated(self, simulator: Simulator) -> Answer:
        """Return how rows answer, from memory where the simulator was seen just before."""
        return self._answers.of(simulator.effects, lambda: self._evaluate(simulator))

    def _evaluate(self, simulator: Simulator) -> Answer:
        count, recorded = len(self._blocks), self.inside(simulator)
        bare = bare_rows(simulator, self._joined, self._functions, self._inside(simulator))
        rows = bare[:count] * row_weights(simulator, recorded, self._blocks, self._functions)
        some, still = bare[self._part] * self._sound, bare[count:] * self._sound
        unloaded = simulator.with_effects(tuple(f for f in simulator.effects if not _loads(f.effect)))
        exerted = self._exerted_by.of(unloaded.effects, lambda: self._exert(unloaded))
        return Answer(rows, some - still, exerted, still)

    def _exert(self, unloaded: Simulator) -> Tensor:
        """Return what the forces of actuators do to the rows of some blocks, (blocks, rows, channels).

        Args:
            unloaded: without loads, such as friction or drag of rotors: they come with the forces of actuators and are
                none of theirs. What a rotor or a gear lacks is.
        """
        inner = {name: series[self._part] for name, series in self._inside(unloaded).items()}
        stalled = self._stalled(unloaded) if self._stalled else inner
        exerted = {name: stalled[name] for name in self._exerted if name in inner}
        nothing = {name: torch.zeros_like(series) for name, series in exerted.items()}
        acting, relaxed = (
            bare_rows(unloaded, self._some, self._functions, inner | forces) for forces in (exerted, nothing)
        )
        return (acting - relaxed) * self._sound


def _loads(effect: Effect) -> bool:
    """Whether an effect is a force beside those of the actuators, and no change of theirs."""
    return isinstance(effect, WrenchEffect) and effect.acts_on != "actuator" and not effect.takes_share


def _relative(changed: Tensor, nominal: Tensor) -> Tensor:
    """Return the spread of a change of rows over that of a nominal one, (channels,); infinite where that is none."""
    gain, usual = _spread(changed), _spread(nominal)
    return torch.where(usual > 0.0, torch.maximum(gain, _LEAST * usual) / usual, torch.inf)


def _spread(rows: Tensor) -> Tensor:
    """Return the mean deviation of rows from their mean, (channels,): a trim that others cancel is no answer."""
    return (rows - rows.mean((0, 1))).abs().mean((0, 1))


def _without_commands(blocks: Blocks) -> Blocks:
    """Return blocks with commands that ask for nothing: none, or a servo's own position."""
    silent = {name: torch.zeros_like(series) for name, series in blocks.signals.items() if name in COMMANDS}
    if "position_command" in silent:
        silent["position_command"] = blocks.signals["position"]
    held = {name: silent[name] for name in blocks.held_commands}
    if "run_number" in blocks.signals:  # copies are other runs: effects that join blocks must not mix them
        silent["run_number"] = -1.0 - blocks.signals["run_number"]
    return replace(blocks, signals={**blocks.signals, **silent}, held_commands=held)


def _at_rest(blocks: Blocks) -> Blocks:
    """Return blocks of an axis that is held still, whatever drives it."""
    return replace(
        blocks, signals=blocks.signals | {"velocity": torch.zeros_like(blocks.signals["velocity"])}
    )


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
