"""Trends: an effect that grows from nothing or fades to nothing while a machine is recorded.

Bearings wear, motors heat up, grease gets thin. No law of the catalogue changes slowly, and what changes would pass for
whichever law follows the same motions at the same time. A trend is another hypothesis, scored as all are; it has no
name. Its effect is a copy beside the one that stays, so that a machine may have both.
"""

import math
from collections.abc import Iterable, Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import cache

import torch
from torch import Tensor

from simgap.effects import DryFriction, Effect
from simgap.effects.dry_friction import SHARE
from simgap.simulation import FittedEffect, Simulator
from simgap.simulation.blocks import Blocks

_SETTLING = 0.25
"""Of the time that is recorded, the time constant of what comes to an end in it: after four of them 2 % are left."""


@dataclass(frozen=True)
class Trend:
    """How one effect grows or fades, in a straight line or as what warms up.

    Attributes:
        key: of the copy that does.
        origins: time at which it begins, in each run's own time, (runs,) s.
        span: how long it takes, s.
        settling: time constant with which it comes to its end, s; None for a straight line.
        grows: whether it grows from nothing; otherwise it fades to nothing.
        is_dry: whether it is dry friction.
        begins_anew: whether it begins anew with each run.
    """

    key: str
    origins: tuple[float, ...]
    span: float
    settling: float | None
    grows: bool
    is_dry: bool
    begins_anew: bool

    @property
    def keys(self) -> tuple[str, ...]:
        """Of the effects that do not act alike everywhere."""
        return (self.key,)

    def share(self, blocks: Blocks) -> Tensor:
        """Return how much of the effect acts in the middle of each block, (blocks,)."""
        origins = torch.tensor(self.origins, dtype=blocks.start.dtype)[blocks.run]
        middle = blocks.start + 0.5 * blocks.samples * blocks.time_step
        passed = (middle - origins).clamp(0.0, self.span)
        done = passed / self.span
        if self.settling is not None:
            done = torch.expm1(-passed / self.settling) / math.expm1(-self.span / self.settling)
        return done if self.grows else 1.0 - done

    @property
    def is_straight(self) -> bool:
        """Whether it goes in a straight line through the whole recording."""
        return self.settling is None and not self.begins_anew

    def of(self, effect: Effect) -> "Trend":
        """Return the same trend of another effect."""
        return replace(self, key=trending(effect).key, is_dry=isinstance(effect, DryFriction))

    def acts(self, blocks: Blocks) -> Tensor:
        """Return in which blocks all effects act, if only in part: all of them, (blocks,)."""
        return torch.ones(len(blocks), dtype=torch.bool)

    def without(self, simulator: Simulator) -> Simulator:
        """Return a simulator as it is where nothing of the effect acts; rows in between are between those of the two.

        Not so where dry friction holds an axis at rest, whatever its level: it knows its share itself, see `marked`.
        """
        if self.is_dry:
            return simulator
        return simulator.with_effects(tuple(f for f in simulator.effects if f.effect.key != self.key))

    def marked(self, blocks: Blocks) -> Blocks:
        """Return blocks that say how much of the effect acts in each."""
        length = next(iter(blocks.signals.values())).shape[1]
        share = self.share(blocks)[:, None].expand(-1, length)
        return replace(blocks, signals={**blocks.signals, SHARE: share})

    @property
    def sentence(self) -> str:
        """How the effect changes, as a person reads it."""
        every = "each run" if self.begins_anew else "the recording"
        return f"grows through {every}" if self.grows else f"fades through {every}"


def trends_of(effect: Effect, recorded: Sequence[Blocks]) -> list[Trend]:
    """Return the trends that an effect may have: through the recording, or through each run, growing or fading.

    Args:
        effect: that grows or fades.
        recorded: all blocks of a recording: a machine also changes while a run is recorded that no fit sees.
    """
    key, is_dry, runs = trending(effect).key, isinstance(effect, DryFriction), _runs(recorded)
    clocks = [(*_through_all(runs), False)]
    if len(runs) > 1:
        clocks.append((*_through_each(runs), True))
    return [
        Trend(key, origins, span, settling, grows, is_dry, begins_anew)
        for origins, span, begins_anew in clocks
        for settling in (None, _SETTLING * span)
        for grows in (True, False)
    ]


@cache
def trending(effect: Effect) -> Effect:
    """Return the copy of an effect that grows or fades; the same one every time."""
    copied = copy(effect)
    copied.trends = True
    return copied


def at_mean(simulator: Simulator, share: float, lasting: Iterable[Effect]) -> Simulator:
    """Return a simulator in which as much stays of what grows or fades as acts on average.

    Args:
        simulator: with at most one effect that grows or fades.
        share: of it that acts on average.
        lasting: the effects of the catalogue.
    """
    changing = next((f for f in simulator.effects if f.effect.trends), None)
    if changing is None:
        return simulator
    effect = next(each for each in lasting if trending(each) is changing.effect)
    there = next((f for f in simulator.effects if f.effect.key == effect.key), None)
    others = tuple(f for f in simulator.effects if f not in (changing, there))
    return simulator.with_effects(
        (*others, FittedEffect(effect, _mean_values(effect, changing, there, share)))
    )


def _mean_values(
    effect: Effect, changing: FittedEffect, there: FittedEffect | None, share: float
) -> dict[str, float]:
    """Return the values of an effect that acts as much as a share of what changes does beside what is there."""
    size = effect.parameters[0]
    values = dict(there.values if there else changing.values)
    least = values[size.name] if there else size.neutral
    values[size.name] = least + share * (changing.values[size.name] - size.neutral)
    return values


def _through_all(runs: list[tuple[float, float]]) -> tuple[tuple[float, ...], float]:
    """Return when each run began, less the time that all before it took, and the time that all took, s."""
    passed, origins = 0.0, []
    for first, duration in runs:
        origins.append(first - passed)
        passed += duration
    return tuple(origins), passed


def _through_each(runs: list[tuple[float, float]]) -> tuple[tuple[float, ...], float]:
    """Return when each run began, and the time that the longest took, s."""
    return tuple(first for first, _ in runs), max(duration for _, duration in runs)


def _runs(recorded: Sequence[Blocks]) -> list[tuple[float, float]]:
    """Return the start and the duration of each run as far as blocks show them, s."""
    run = torch.cat([blocks.run for blocks in recorded])
    start = torch.cat([blocks.start for blocks in recorded])
    length = recorded[0].samples * recorded[0].time_step
    found = []
    for index in range(len(recorded[0].runs)):
        own = start[run == index]
        found.append((float(own.min()), float(own.max() - own.min()) + length) if len(own) else (0.0, 0.0))
    return found
