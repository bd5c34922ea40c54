"""Actuator chain: command delays, the nominal actuator and the actuator effects, in their order."""

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import Any

from torch import Tensor

from simgap.effects import ActuatorEffect, CommandEffect
from simgap.physics.shapes import Signal, Signals
from simgap.simulation.simulator import FittedEffect, Simulator

Memory = tuple[Any, ...]
"""What each effect that remembers remembers, in the order in which they act."""


def command_effects(simulator: Simulator) -> list[FittedEffect]:
    """Return the effects between the command and the actuator."""
    return simulator.of_type(CommandEffect)


def actuator_effects(simulator: Simulator) -> list[FittedEffect]:
    """Return the effects behind the nominal actuator, in their order."""
    return [f for f in simulator.of_type(ActuatorEffect) if not isinstance(f.effect, CommandEffect)]


def held_through(
    simulator: Simulator,
    signals: Signals,
    constants: Mapping[str, Any],
    memory: Memory,
    time_step: float,
) -> tuple[list[dict[str, Signal]], Memory]:
    """Run the effects that have a state through one integration step.

    The output of such an effect is its mean over the step. The change that it makes is held, so that all else (a
    back-EMF) still follows the motion within the step.

    Args:
        simulator: platform and effects.
        signals: of the state and the command at the step's start.
        constants: of the simulator.
        memory: after the step before; empty before the first.
        time_step: of the integration, s.

    Returns:
        What each effect that remembers adds to each signal, in the order in which they act, and the memory after the
        step.
    """
    held: list[dict[str, Tensor]] = []
    after: list[Any] = []
    act = partial(_acting_and_held, constants, time_step, iter(memory), held, after)
    _passed(simulator, signals, constants, act)
    return held, tuple(after)


def actuated(
    simulator: Simulator,
    signals: Signals,
    constants: Mapping[str, Any],
    held: list[dict[str, Signal]],
    time_step: float,
) -> dict[str, Signal]:
    """Return the signals at one instant of a step, with the held outputs of effects that have a state."""
    return _passed(simulator, signals, constants, partial(_as_held, constants, time_step, iter(held)))


def _passed(
    simulator: Simulator,
    signals: Mapping[str, Tensor],
    constants: Mapping[str, Any],
    act: Callable[[FittedEffect, dict[str, Tensor]], dict[str, Tensor]],
) -> dict[str, Tensor]:
    """Return the signals after the effects on the command, the nominal actuator and the effects behind it."""
    now = dict(signals)
    for fitted in command_effects(simulator):
        now |= act(fitted, now)
    given = simulator.mechanism.given_output(now)
    now = simulator.mechanism.actuate(now, constants)
    for fitted in actuator_effects(simulator):
        now |= without(act(fitted, now), given)
    return now


def _acting_and_held(
    constants: Mapping[str, Any],
    time_step: float,
    memories: Iterator[Any],
    held: list[dict[str, Tensor]],
    after: list[Any],
    fitted: FittedEffect,
    now: dict[str, Tensor],
) -> dict[str, Tensor]:
    """Let an effect act on the signals; where it remembers, put down what it changes and its memory."""
    effect: Any = fitted.effect
    if not effect.remembers:
        return effect.actuate(now, fitted.values, constants, None, time_step)[0]
    out, kept = effect.actuate(now, fitted.values, constants, next(memories, None), time_step)
    after.append(kept)
    held.append({n: value - now[n] if n in now else value for n, value in out.items()})
    return out


def _as_held(
    constants: Mapping[str, Any],
    time_step: float,
    outputs: Iterator[dict[str, Tensor]],
    fitted: FittedEffect,
    now: dict[str, Tensor],
) -> dict[str, Tensor]:
    """Let an effect act on the signals; where it remembers, by what it changed at the start of the step."""
    effect: Any = fitted.effect
    if effect.remembers:
        return {n: now[n] + change if n in now else change for n, change in next(outputs).items()}
    return effect.actuate(now, fitted.values, constants, None, time_step)[0]


def without(changed: dict[str, Signal], given: str | None) -> dict[str, Signal]:
    """Leave out measured signals, which no effect changes."""
    return {name: value for name, value in changed.items() if name != given}
