"""Replay of a recording: open-loop simulation with the recorded commands, from a recorded state."""

from collections.abc import Mapping
from typing import Any

import torch
from jaxtyping import Float
from torch import Tensor

from simgap.effects import ActuatorEffect, CommandEffect, Effect, MeasurementEffect
from simgap.physics.shapes import Signal, Signals
from simgap.simulation.actuation import Memory, held_through
from simgap.simulation.blocks import Blocks
from simgap.simulation.learned import DYNAMICS, Learned
from simgap.simulation.motion import motion_of
from simgap.simulation.odometry import moving, shown
from simgap.simulation.rollout import rollout
from simgap.simulation.simulator import Simulator

_TRIAL_BLOCKS = 12  # blocks that tell how fine the steps have to be
_MOST_SUBSTEPS = 16
_NEGLIGIBLE = 0.02  # of the error of a prediction: in quadrature it adds 0.02 %


def replay(
    simulator: Simulator,
    blocks: Blocks,
    initial: Float[Tensor, "blocks components"],
    steps: int,
    substeps: int = 1,
) -> Float[Tensor, "blocks samples components"]:
    """Simulate every block with its recorded commands and other recorded external signals.

    Time offsets and delays are applied to the whole block first, since the margin holds the earlier commands. Effects
    with a state run through the margin on recorded signals. What acts on a command at once acts in the simulation, for
    it may depend on the motion.

    Args:
        simulator: platform and effects.
        blocks: of a recording.
        initial: recorded states at the first sample of each block, (blocks, n).
        steps: at most one less than the samples of a block.
        substeps: integration steps between two samples.

    Returns:
        States (blocks, steps + 1, n).
    """
    if simulator.learned is not None and simulator.learned.role == DYNAMICS:
        return _replay_learned(simulator, simulator.learned, blocks, initial, steps)
    signals, held = (
        _after_commands(simulator, series, blocks) for series in (blocks.signals, blocks.held_commands)
    )
    bare = simulator.with_effects(tuple(f for f in simulator.effects if not _is_settled(f.effect)))
    within = slice(blocks.margin, blocks.margin + steps)
    made = motion_of(simulator.platform, blocks.signals).signals(initial).keys()
    outside = {name: _over_steps(series, within) for name, series in signals.items() if name not in made}
    outside |= {name: series[:, within] for name, series in held.items()}
    initial = moving(simulator, initial, {name: series[:, blocks.margin] for name, series in signals.items()})
    memory = _lived_through(bare, signals | held, blocks)
    if simulator.learned is not None:
        memory = (*memory, simulator.learned.begin(_until_first(blocks)))
    states = rollout(bare, initial, outside, blocks.time_step, substeps, memory=memory)
    return shown(simulator, states, signals)


def _replay_learned(
    simulator: Simulator, learned: Learned, blocks: Blocks, initial: Tensor, steps: int
) -> Tensor:
    """Replay with learned dynamics: the model has seen the inputs as recorded, and all effects are in it."""
    within = slice(blocks.margin, blocks.margin + steps)
    known = blocks.signals | blocks.held_commands
    commands = {name: known[name][:, within] for name in learned.inputs}
    memory = (learned.begin(_until_first(blocks)),)
    return rollout(simulator.with_effects(()), initial, commands, blocks.time_step, memory=memory)


def _until_first(blocks: Blocks) -> dict[str, Tensor]:
    """Return the recorded signals of the margin before each block, and of its first sample."""
    known = blocks.signals | blocks.held_commands
    return {name: series[:, : blocks.margin + 1] for name, series in known.items()}


def _is_settled(effect: Effect) -> bool:
    """Whether an effect is applied to the recorded signals before a simulation: a sensor's, or a delay of commands."""
    return isinstance(effect, MeasurementEffect) or (isinstance(effect, CommandEffect) and effect.remembers)


def _after_commands(simulator: Simulator, signals: Mapping[str, Tensor], blocks: Blocks) -> dict[str, Tensor]:
    """Return signals without what the sensors did to them, and with delays applied."""
    out, constants = without_sensors(simulator, signals, blocks.time_step), simulator.constants()
    for fitted in simulator.of_type(CommandEffect):
        if out and _is_settled(fitted.effect):
            effect: Any = fitted.effect
            out = effect.along_time(out, fitted.values, constants, blocks.time_step)
    return out


def without_sensors(simulator: Simulator, signals: Signals, time_step: float) -> dict[str, Signal]:
    """Return recorded blocks (blocks, samples, ...) without what the measurement effects of a simulator did to them.

    A state to start from, or to compare a prediction with, has to be taken from these.
    """
    out = dict(signals)
    for fitted in simulator.of_type(MeasurementEffect):
        out = {**out, **fitted.effect.undo(out, fitted.values, time_step)}  # type: ignore[attr-defined]
    return out


def _over_steps(series: Tensor, within: slice) -> Tensor:
    """Return the mean over each step of a signal that belongs to its samples."""
    return 0.5 * (series[:, within] + series[:, within.start + 1 : within.stop + 1])


def _lived_through(simulator: Simulator, signals: Mapping[str, Tensor], blocks: Blocks) -> Memory:
    """Return the states of the effects at the end of the margin before each block."""
    memory: Memory = ()
    if not any(fitted.effect.remembers for fitted in simulator.of_type(ActuatorEffect)):  # type: ignore[attr-defined]
        return memory
    constants = simulator.constants()
    for sample in range(blocks.margin):
        now = {name: series[:, sample] for name, series in signals.items()}
        _, memory = held_through(simulator, now, constants, memory, blocks.time_step)
    return memory


def substeps_for(
    simulator: Simulator, blocks: Blocks, steps: int, tolerance: Float[Tensor, " components"]
) -> int:
    """Return the number of integration steps between two samples that makes the integration error negligible.

    Sticking friction and stiff contacts need more than one. The number doubles until a further doubling moves no
    component of the state by more than the tolerance, or than a small share of what the prediction misses anyway, as a
    root mean square over a few blocks.

    Args:
        simulator: platform and effects.
        blocks: of a recording.
        steps: of the predictions.
        tolerance: of each component of the state, (n,).
    """
    few = blocks.thinned(_TRIAL_BLOCKS)
    motion = motion_of(simulator.platform, blocks.signals)
    signals = without_sensors(simulator, few.signals, few.time_step)
    inner = {name: few.inner(series)[:, : steps + 1] for name, series in signals.items()}
    recorded = motion.pack(inner)
    substeps, coarse = 1, replay(simulator, few, recorded[:, 0], steps)
    while substeps < _MOST_SUBSTEPS:
        fine = replay(simulator, few, recorded[:, 0], steps, 2 * substeps)
        moved, missed = (_rms(other - fine) for other in (coarse, recorded))
        allowed = torch.maximum(tolerance, _NEGLIGIBLE * torch.nan_to_num(missed, posinf=0.0))
        if bool((torch.nan_to_num(moved, nan=torch.inf) <= allowed).all()):
            break
        substeps, coarse = 2 * substeps, fine
    return substeps


def _rms(series: Tensor) -> Tensor:
    """Return the root mean square of each component of (blocks, samples, n), (n,)."""
    return series.square().mean((0, 1)).sqrt()


def replay_error(simulator: Simulator, blocks: Blocks, duration: float) -> dict[str, float]:
    """Return the root mean square error of each part of the state after replaying for a duration, in SI units."""
    steps = max(min(round(duration / blocks.time_step), blocks.samples - 1), 1)
    motion = motion_of(simulator.platform, blocks.signals)
    signals = without_sensors(simulator, blocks.signals, blocks.time_step)
    recorded = motion.pack({name: blocks.inner(series) for name, series in signals.items()})
    last = replay(simulator, blocks, recorded[:, 0], steps)[:, -1]
    difference = last - recorded[:, steps]
    rms = {name: difference[:, where].square().sum(-1).mean().sqrt() for name, where in motion.parts.items()}
    return {
        f"replay_error_{name}": float(torch.nan_to_num(value, nan=torch.inf)) for name, value in rms.items()
    }
