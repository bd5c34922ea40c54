"""The data that all fits of one diagnosis share, and what a simulator leaves of them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import torch
from torch import Tensor

from simgap.effects import Effect, WrenchEffect
from simgap.equations.command_gain import CommandGain
from simgap.equations.presence import Presence
from simgap.equations.residuals import Inside, channels_on, residual_rows, row_weights, signals_inside
from simgap.equations.row_noise import share_of_motion
from simgap.equations.temper import Temper, energy_of
from simgap.equations.trend import Trend
from simgap.physics.shapes import Channels
from simgap.physics.weak_form import WindowFunctions
from simgap.simulation import Simulator
from simgap.simulation.blocks import Blocks

_LIKELIHOOD_TOLERANCE = 1e-2  # least promised gain of log likelihood


@dataclass(frozen=True)
class Problem:
    """The data that all fits of one diagnosis share.

    Attributes:
        blocks: the stretches that are fitted.
        functions: the windows that residuals are averaged over.
        noise: standard deviation of a row by sensor noise alone, (channels,).
        quadrature: by how much sums over samples may miss the integrals that rows are, RMS, (channels,).
        cluster: stretches within which residuals may be correlated, (blocks,).
        temper: how rows count.
        sizes: typical effort, travel and speed of the recording, see `simgap.effects.sizes`.
        counted: how rows count in a likelihood, see `simgap.gap.likelihood.counted_beside`; the same for all readings.
        nominal: the simulator whose rows keep their size; rows of all simulators do where it is None.
        is_axis: whether both sides of its equation stand for one effort.
        presence: of effects that act in a part of the blocks, or change from block to block; None: all effects act in
            all of them alike.
    """

    blocks: Blocks
    functions: WindowFunctions
    noise: Tensor
    quadrature: Tensor
    cluster: Tensor
    temper: Temper
    sizes: Mapping[str, float] = field(default_factory=dict)
    counted: Temper | None = None
    nominal: Simulator | None = None
    is_axis: bool = False
    presence: Presence | Trend | None = None

    @cached_property
    def gain(self) -> CommandGain | None:
        """How strongly rows answer to the commands."""
        return None if self.nominal is None else CommandGain(self.nominal, self.blocks, self.functions)

    def inside(self, simulator: Simulator) -> dict[str, Tensor]:
        """Return the signals in a simulator, see `simgap.equations.residuals.signals_inside`."""
        return self._inside(simulator) if self.gain is None else self.gain.inside(simulator)

    @cached_property
    def _inside(self) -> Inside:
        return Inside(self.blocks)

    def factor(self, simulator: Simulator) -> Tensor:
        """Return the factors that put the rows of a simulator on the side of its commands, (channels,)."""
        return torch.ones_like(self.noise) if self.gain is None else self.gain.factor(simulator)

    def loudness(self, simulator: Simulator) -> Tensor:
        """Return by how much the noise of rows exceeds that of nominal ones at most, (channels,).

        Where commands do less, the noise of the motion is larger on the side of the commands.
        """
        return (1.0 + self.of_motion * (self.factor(simulator).square() - 1.0)).sqrt().clamp_min(1.0)

    @cached_property
    def of_motion(self) -> Tensor:
        """Share of the noise's energy that is the recorded motion's, (channels,)."""
        if self.nominal is None:
            return torch.ones_like(self.noise)
        return share_of_motion(self.nominal, self.blocks, self.functions)

    def weigh(self, residual: Tensor, simulator: Simulator | None = None) -> tuple[Tensor, float]:
        """Return what rows are weighed with, and what they cost.

        Args:
            residual: (blocks, rows, channels).
            simulator: that leaves it; None: the nominal one.

        Returns:
            The standard deviation that each row would have if it counted once, (blocks, 1, channels) or another shape
            that fits a residual, and the negative log likelihood up to a constant.
        """
        loudness = 1.0 if simulator is None else self.loudness(simulator)
        noise = (loudness * self.noise).square().clamp_min(1e-24)
        left = energy_of(residual, noise)
        mixture = self.temper.mixture(left, noise)
        scale = self.temper.weight_of(mixture, left, noise).rsqrt()[:, None]
        return scale, -float(self.temper.value_of(mixture, left, noise).sum())

    def cost(self, residual: Tensor, simulator: Simulator) -> float:
        """Return the negative log likelihood of a residual (blocks, rows, channels), up to a constant."""
        return self.weigh(residual, simulator)[1]

    def least_gain(self, residual: Tensor) -> float:
        """Return the decrease of the weighted cost that is worth another step of a fit."""
        return _LIKELIHOOD_TOLERANCE

    def residual(self, simulator: Simulator) -> Tensor:
        """Return what a simulator leaves of the equations of motion, (blocks, rows, channels).

        It is in terms of the commands, see `simgap.equations.command_gain`.
        """
        return self._where_present(simulator, self._rows)

    @cached_property
    def acts(self) -> Tensor:
        """Whether all effects act in a block, (blocks,)."""
        everywhere = torch.ones(len(self.blocks), dtype=torch.bool)
        return everywhere if self.presence is None else self.presence.acts(self.blocks)

    @property
    def present(self) -> Tensor:
        """The blocks in which all effects act, (present blocks,)."""
        return torch.nonzero(self.acts).squeeze(1)

    @cached_property
    def share(self) -> Tensor:
        """How much of the effects that do not act alike everywhere acts in a block, (blocks,)."""
        everywhere = torch.ones(len(self.blocks), dtype=torch.float64)
        return everywhere if self.presence is None else self.presence.share(self.blocks)

    def _where_present(self, simulator: Simulator, series: Callable[[Simulator], Tensor]) -> Tensor:
        """Return a series of a simulator, (blocks, ...), with as much of each effect as acts in a block."""
        if self.presence is None:
            return series(simulator)
        elsewhere = self.presence.without(simulator)
        if elsewhere == simulator:
            return series(simulator)
        found = series(simulator)
        share = self.share.reshape(-1, *(1,) * (found.dim() - 1))
        return torch.lerp(series(elsewhere), found, share)

    def _rows(self, simulator: Simulator) -> Tensor:
        if self.gain is None:
            return residual_rows(simulator, self.blocks, self.functions)
        return self.gain.rows(simulator)

    def regressors(self, simulator: Simulator, effect: Effect) -> Tensor | None:
        """Return the columns of an effect that is linear here, (blocks, rows, channels, parameters), else None."""
        if not simulator.is_linear_in(effect):
            return None
        assert isinstance(effect, WrenchEffect)
        if self.presence is not None and effect.key in self.presence.keys:
            return self._columns(simulator, effect) * self.share[:, None, None, None]
        return self._where_present(simulator, lambda each: self._columns(each, effect))

    def is_sum_with(self, simulator: Simulator, effect: Effect) -> bool:
        """Whether an effect only adds to the rows of a simulator, see `Simulator.is_sum_with`."""
        return simulator.is_sum_with(effect)

    def summands(self, base: Simulator, effect: Effect, choices: Sequence[Mapping[str, float]]) -> Tensor:
        """Return what an effect that only adds to what acts takes off the rows, (blocks, rows, channels, choices).

        Args:
            base: what else acts; the effect itself may be there.
            effect: only adds to the rows of the base, see `is_sum_with`.
            choices: of its values.
        """
        assert isinstance(effect, WrenchEffect)

        def taken(each: Simulator) -> Tensor:
            inner = _derived(each, self.inside(each))
            wrenches = [effect.wrench(inner, values, each.constants()) for values in choices]
            return self._in_windows(each, _series_of(each, wrenches, self.blocks, inner))

        if self.presence is not None and effect.key in self.presence.keys:
            return taken(base) * self.share[:, None, None, None]
        return self._where_present(base, taken)

    def _columns(self, simulator: Simulator, effect: WrenchEffect) -> Tensor:
        inner = _derived(simulator, self.inside(simulator))
        return self._in_windows(simulator, law_series(simulator, effect, self.blocks, inner))

    def _in_windows(self, simulator: Simulator, series: Tensor) -> Tensor:
        """Return series (blocks, samples, channels, columns) as rows are: (blocks, rows, channels, columns)."""
        rows = torch.einsum("bscp,rs->brcp", series, self.functions.weights)
        weights = row_weights(simulator, self.inside(simulator), self.blocks, self.functions)
        return rows * (weights * self.factor(simulator))[..., None]


def law_series(
    simulator: Simulator, effect: WrenchEffect, blocks: Blocks, inner: dict[str, Tensor] | None = None
) -> Tensor:
    """Return what one unit of each parameter of a linear effect does, (blocks, samples, channels, parameters).

    Args:
        simulator: that the effect acts in.
        effect: linear there.
        blocks: recorded.
        inner: what is in the simulator, with what its mechanism derives, where that is known.
    """
    inner = inner or _derived(simulator, signals_inside(simulator, blocks, blocks.acting))
    regressors = effect.regressors(inner, simulator.constants())
    return _series_of(simulator, regressors, blocks, inner)


def _series_of(
    simulator: Simulator, wrenches: Sequence[Channels], blocks: Blocks, inner: dict[str, Tensor]
) -> Tensor:
    """Return what wrenches do once constraints answer them, (blocks, samples, channels, wrenches)."""
    constants = simulator.constants()
    nominal, believed = simulator.nominal_inertia(), simulator.mechanism.inertia(constants)
    names = [channel.name for channel in channels_on(simulator, blocks)]
    columns = []
    for each in wrenches:
        wrench = simulator.mechanism.constrain(each, inner, constants)
        acting = {n: nominal[n] / believed[n] * blocks.at_samples(series) for n, series in wrench.items()}
        zero = torch.zeros_like(next(iter(acting.values())))
        columns.append(torch.stack([acting.get(name, zero) for name in names], dim=-1))
    return torch.stack(columns, dim=-1)


def _derived(simulator: Simulator, inner: dict[str, Tensor]) -> dict[str, Tensor]:
    """Return the signals inside a simulator with those that its mechanism derives."""
    return inner | simulator.mechanism.derived(inner, simulator.constants())
