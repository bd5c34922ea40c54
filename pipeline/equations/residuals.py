"""The residual of a simulator in weak form, channel by channel, and its noise floor."""

import math
from dataclasses import dataclass

import torch
from torch import Tensor

from simgap.effects import ActuatorEffect, ConstantEffect, Effect, MeasurementEffect
from simgap.equations.recent import Recent
from simgap.physics.weak_form import WindowFunctions, mean_of, mean_rate_of
from simgap.platforms.mechanism import Channel
from simgap.simulation import Simulator
from simgap.simulation.blocks import Blocks
from simgap.simulation.replay import without_sensors

_TOUCHED = 1e-3  # of a window's weight; a lost command at its edge does no harm
_LEAST_SOUND = 0.5  # least share of windows without lost commands
_KEPT = 4
"""Simulators whose signals are kept: parameters of forces are moved one after the other beside the same ones."""


@dataclass(frozen=True)
class ChannelSeries:
    """Both sides of one equation on the samples of the blocks.

    Attributes:
        channel: which equation.
        measured: what a sensor read of the wrench, the momentum whose rate it is, or one of two readings of the same;
            (blocks, samples).
        predicted: what the simulator says, (blocks, samples).

    Both are in terms of the platform's nominal inertia, so that a simulator cannot shrink its error by shrinking the
    momentum: what is compared is always the recorded motion.
        direct: whether `measured` is held against `predicted` itself (an accelerometer) rather than by its rate.
    """

    channel: Channel
    measured: Tensor
    predicted: Tensor
    direct: bool


def channels_on(simulator: Simulator, blocks: Blocks) -> tuple[Channel, ...]:
    """Return the channels (equations) that a recording allows to compare."""
    return simulator.mechanism.channels_of(blocks.signals)


def channel_series(
    simulator: Simulator, blocks: Blocks, inner: dict[str, Tensor] | None = None
) -> list[ChannelSeries]:
    """Evaluate a simulator on recorded blocks, their margins dropped.

    Args:
        simulator: to evaluate.
        blocks: recorded.
        inner: what is in it, see `signals_inside`, where that is known.
    """
    inner = inner or signals_inside(simulator, blocks, blocks.acting)
    balance = simulator.balance(inner)
    true = without_sensors(simulator, blocks.signals, blocks.time_step)
    recorded = {name: blocks.inner(series) for name, series in true.items()}
    momentum = simulator.mechanism.momentum(recorded, simulator.constants())
    channels = channels_on(simulator, blocks)
    readings = {}
    if len(channels) > len(simulator.mechanism.channels):
        sampled = _at_samples(simulator, inner, recorded, blocks)
        readings = simulator.mechanism.readings(sampled, simulator.constants())
    nominal, believed = simulator.nominal_inertia(), simulator.mechanism.inertia(simulator.constants())
    series = []
    for channel in channels:
        if channel.name in readings:
            series.append(ChannelSeries(channel, *readings[channel.name], direct=True))
            continue
        scale = nominal[channel.name] / believed[channel.name]
        sensed = _sensed(channel, recorded)
        if sensed is not None:
            predicted = blocks.at_samples(balance.wrench[channel.name])
            series.append(ChannelSeries(channel, sensed, predicted, direct=True))
        else:
            measured = momentum[channel.name] * settling_of(channel.name, simulator, blocks)
            predicted = blocks.at_samples(balance.rate[channel.name])
            series.append(ChannelSeries(channel, scale * measured, scale * predicted, direct=False))
    return series


def _at_samples(
    simulator: Simulator, inner: dict[str, Tensor], recorded: dict[str, Tensor], blocks: Blocks
) -> dict[str, Tensor]:
    """Return the motion as it was sampled, and what acts as its mean around each sample.

    Of the motion no mean will do: over a step a wheel turns so far that its mean cosine is not that of its mean angle.
    """
    acting = {name: blocks.at_samples(series) for name, series in inner.items()}
    driven = simulator.mechanism.actuator_signals
    return acting | {name: series for name, series in recorded.items() if name not in driven}


def signals_inside(simulator: Simulator, blocks: Blocks, acting: dict[str, Tensor]) -> dict[str, Tensor]:
    """Return the signals in a simulator; effects with memory are run from the start of each block's margin."""
    signals = simulator.along_time(acting, blocks.time_step)
    return {name: blocks.acting_inside(series) for name, series in signals.items()}


class Inside:
    """What is in simulators of one recording, from memory where nothing before the forces has changed."""

    def __init__(self, blocks: Blocks) -> None:
        """Begin with an empty memory."""
        self._blocks = blocks
        self._recent = Recent[dict[str, Tensor]](_KEPT)

    def __call__(self, simulator: Simulator) -> dict[str, Tensor]:
        """Return the signals in a simulator, see `signals_inside`."""
        effects = [fitted for fitted in simulator.effects if _comes_before_forces(fitted.effect)]
        return self._recent.of(effects, lambda: signals_inside(simulator, self._blocks, self._blocks.acting))


def _comes_before_forces(effect: Effect) -> bool:
    """Whether what is in a simulator depends on an effect, and not only the forces that follow."""
    return isinstance(effect, MeasurementEffect | ActuatorEffect | ConstantEffect)


def settling_of(channel: str, simulator: Simulator, blocks: Blocks) -> float:
    """Return the factor on the momentum of an axis that settles between two samples of a held command.

    Between samples the velocity is an exponential, of which the trapezoid rule misses a part; the equation
    u = v̄ + (dv/dt)/rate is exact for the sampled means when 1/rate is multiplied by x·coth(x), x = rate·dt/2.
    """
    rate = simulator.mechanism.damping(simulator.mechanism.constants()).get(channel, 0.0)
    x = 0.5 * rate * blocks.time_step
    return x / math.tanh(x) if blocks.held and x > 1e-6 else 1.0


def _sensed(channel: Channel, signals: dict[str, Tensor]) -> Tensor | None:
    if channel.group != "force" or "specific_force" not in signals:
        return None
    return signals["specific_force"][..., "xyz".index(channel.name[-1])]


def measured_rows(series: ChannelSeries, blocks: Blocks, functions: WindowFunctions) -> Tensor:
    """Return the measured side of a channel over the windows, (blocks, rows)."""
    if series.direct:
        return mean_of(functions, series.measured)
    return mean_rate_of(functions, series.measured, blocks.held)


def residual_rows(simulator: Simulator, blocks: Blocks, functions: WindowFunctions) -> Tensor:
    """Return measured minus predicted, averaged over the windows: (blocks, rows, channels) in the channels' units."""
    inner = signals_inside(simulator, blocks, blocks.acting)
    rows = bare_rows(simulator, blocks, functions, inner)
    return rows * row_weights(simulator, inner, blocks, functions)


def bare_rows(
    simulator: Simulator, blocks: Blocks, functions: WindowFunctions, inner: dict[str, Tensor]
) -> Tensor:
    """Return measured minus predicted of all windows, (blocks, rows, channels), from what is in a simulator."""
    rows = [
        measured_rows(series, blocks, functions) - mean_of(functions, series.predicted)
        for series in channel_series(simulator, blocks, inner)
    ]
    return torch.stack(rows, dim=-1)


def row_weights(
    simulator: Simulator, inner: dict[str, Tensor], blocks: Blocks, functions: WindowFunctions
) -> Tensor:
    """Return the weight of each window in each channel, (blocks, rows, channels or 1).

    While a motor is inside a gap, the recorded motion is that of the load alone. All terms of its equation are then
    smaller by the motor's share of the inertia, and so would be any error: a row is in terms of the whole inertia.

    Args:
        simulator: whose rows they are.
        inner: what is in it, see `signals_inside`.
        blocks: recorded.
        functions: the windows.
    """
    weights = without_lost(blocks, functions)
    free = simulator.mechanism.free_inertia(inner)
    if not free:
        return weights
    names = [channel.name for channel in channels_on(simulator, blocks)]
    coupled = torch.ones((*weights.shape[:2], len(names)), dtype=weights.dtype)
    for place, name in enumerate(names):
        if name in free:
            coupled[..., place] -= mean_of(functions, blocks.at_samples(free[name]))
    return weights / coupled


def without_lost(blocks: Blocks, functions: WindowFunctions) -> Tensor:
    """Return the weight of each window, (blocks, rows, 1): zero where it contains a lost command.

    The other windows are scaled so that mean squares over all windows equal those over the measured ones. If half of
    the windows or more would be lost, all count.
    """
    touched = mean_of(functions, blocks.filled)
    sound = (touched < _TOUCHED).to(touched.dtype)
    share = float(sound.mean())
    return (sound / share**0.5)[..., None] if share > _LEAST_SOUND else torch.ones_like(sound)[..., None]


def quadrature_of_rows(simulator: Simulator, blocks: Blocks, functions: WindowFunctions) -> Tensor:
    """Return by how much rows may miss the integrals that they stand for, RMS in each channel's unit, (channels,).

    It is what the midpoint rule over held steps, which rows are taken by, and the trapezoidal rule differ by: the two
    err by the same order with opposite signs. 0 where commands are not held, for there the sums over smooth windows
    converge faster than any power of the time step.
    """
    names = [channel.name for channel in channels_on(simulator, blocks)]
    missed = functions.weights.new_zeros((len(blocks), len(functions.centres), len(names)))
    if blocks.on_steps:
        instants = [blocks.acting_after(part) for part in (0.0, 0.5, 1.0)]
        rates = [simulator.balance(signals_inside(simulator, blocks, acting)).rate for acting in instants]
        for place, name in enumerate(names):
            if name in rates[0]:
                start, middle, end = (blocks.at_samples(rate[name]) for rate in rates)
                missed[..., place] = mean_of(functions, middle - 0.5 * (start + end))
    return missed.square().mean((0, 1)).sqrt()
