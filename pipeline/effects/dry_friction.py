"""Dry friction with sticking, shared by joints, wheels and steered modules."""

from abc import abstractmethod
from typing import ClassVar, NamedTuple

import torch
from torch import Tensor

from simgap.effects.effect import Signals, Values, WrenchEffect
from simgap.physics.shapes import Channels, Real, Value

_NOISY = 8  # exponent on velocity over resolution: a third of the resolution is noise and must count as rest


SHARE = "share_of_trend"
"""The signal that says how much of an effect acts that grows or fades, (blocks, samples)."""


class DryFriction(WrenchEffect):
    """Friction that balances the applied load at standstill, up to its level.

    It applies after all other effects. With several dry frictions, each receives the load that the ones before it have
    not balanced (`Mechanism.loads`).

    Attributes:
        holds: the signal with the remaining load.
        on_each: whether it acts on several wheels or modules, which are the last dimension of what it returns.
    """

    linear = False
    holds: ClassVar[str]
    on_each: ClassVar[bool] = False

    @abstractmethod
    def friction(self, signals: Signals, values: Values, constants: Values) -> Real:
        """Return the friction on the axis (...,), or on each wheel or module (..., 4), N·m or N."""

    def values_now(self, signals: Signals, values: Values) -> Values:
        """Return the values that act: of friction that grows or fades a share of its level, the first of them."""
        if not (self.trends and SHARE in signals):
            return values
        level, share = self.parameters[0].name, signals[SHARE]
        return {**values, level: values[level] * (share[..., None] if self.on_each else share)}

    @abstractmethod
    def on_channels(self, friction: Real, signals: Signals, constants: Values) -> Channels:
        """Return the contribution of a friction to each channel."""

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return the friction on each channel, N·m or N."""
        return self.on_channels(self.friction(signals, values, constants), signals, constants)


class Sliding(NamedTuple):
    """The velocity above which an axis slides in one direction only.

    Attributes:
        velocity: threshold in the unit of the velocity: half of its change within a sample, or its resolution.
        within_samples: whether a slower axis passes through zero within a sample; otherwise it rests.
        resting: share of a sample in which the axis is known to rest, however fast its sensor says that it is.
    """

    velocity: Value
    within_samples: bool
    resting: Value = 0.0

    def moving(self, velocity: Real) -> Real:
        """Return the velocity (...,) without what the sensor makes of an axis at rest."""
        return velocity * (1.0 - torch.as_tensor(self.resting, dtype=velocity.dtype))


def sliding_of(signals: Signals, constants: Values, group: str = "") -> Sliding:
    """Return the sliding threshold: of each sample if known, otherwise one value for the recording.

    Args:
        signals: may hold `sliding_velocity` and `resting`, of the shape of the velocity.
        constants: hold the single value.
        group: prefix of these names: `drive_` or `steer_` for a swerve drive.
    """
    name = f"{group}sliding_velocity"
    resting = signals.get(f"{group}resting", 0.0)
    return Sliding(signals[name], True, resting) if name in signals else Sliding(constants[name], False)


def dry_friction(
    level: Value,
    velocity: Real,
    applied: Real,
    slides: Sliding,
    backward_level: Value | None = None,
) -> Real:
    """Return friction that opposes motion at its level, and at standstill the applied load up to its level (...,).

    An axis that reverses within a sample slides in both directions. Its mean friction is the level times the difference
    of the two shares of time. It sticks longer the slower it is, and the less the applied load exceeds the level. What
    rests is held at the level, whatever load exceeds it.
    Source: Karnopp 1985, Computer simulation of stick-slip friction (ASME J. Dyn. Syst. 107).

    Args:
        level: N·m or N.
        velocity: (...,) rad/s or m/s; the mean over each sample.
        applied: the applied load, (...,) in the unit of the level.
        slides: the sliding threshold.
        backward_level: level in negative motion, if it differs from that in positive motion.
    """
    level = torch.as_tensor(level, dtype=velocity.dtype)
    backward = level if backward_level is None else torch.as_tensor(backward_level, dtype=velocity.dtype)
    # Levels that differ are one level beside a constant load of half their difference.
    level, load = 0.5 * (level + backward), 0.5 * (level - backward)
    applied = applied - load
    held = torch.maximum(torch.minimum(applied, level), -level)
    speed = slides.moving(velocity) / slides.velocity
    if slides.within_samples:
        return _over_samples(level, speed, held, applied, slides.resting) - load
    return _at_an_instant(level, speed, held) - load


def _at_an_instant(level: Tensor, speed: Tensor, held: Tensor) -> Tensor:
    """Blend from sticking to sliding as the speed (...,), in units of the sliding velocity, grows."""
    slip = torch.tanh(speed)
    return -level * slip * slip.abs() - (1.0 - slip.square()) * held


def _over_samples(level: Tensor, speed: Tensor, held: Tensor, applied: Tensor, rests: Value) -> Tensor:
    """Return the mean friction over a sample with sliding in both directions and a share of sticking."""
    direction = speed.clamp(-1.0, 1.0)
    share = held / torch.where(applied == 0.0, 1.0, applied)
    share = torch.where(applied == held, 1.0, share)
    share = share + rests * (1.0 - share)
    resting = (1.0 - direction**_NOISY) * share
    return -(1.0 - resting) * level * direction - resting * held
