"""Dry friction that also holds still, shared by joints, wheels and steered modules."""

from abc import abstractmethod
from typing import ClassVar, NamedTuple

import torch
from torch import Tensor

from simgap.effects.effect import Signals, Values, WrenchEffect
from simgap.physics.shapes import Channels, Real, Value

_FASTEST = 0.99  # quantile of recorded speeds: the very greatest may be a spike
_FADED = 0.5  # of the level at rest, beyond which nothing shows that friction fades at all
_NOISY = (
    8  # power of a share of the resolution: a third, which is the sensor's noise, must be none of a motion
)
_LEAST_KNOWN = 0.2  # of what fades, in motion one way: less is the sensor's noise, or how an axis turns round


class DryFriction(WrenchEffect):
    """Friction that at standstill holds whatever else acts on what it rubs, up to its level.

    It comes after all else that acts. What one holds no other has to hold: of several, each is told what those before
    it have left (`Mechanism.loads`).

    Attributes:
        holds: the signal that says what is left to be held.
    """

    linear = False
    holds: ClassVar[str]

    @abstractmethod
    def friction(self, signals: Signals, values: Values, constants: Values) -> Real:
        """Return the friction on the axis (...,), or on each wheel or module (..., 4), N·m or N."""

    @abstractmethod
    def on_channels(self, friction: Real, signals: Signals, constants: Values) -> Channels:
        """Return what a friction adds to each channel."""

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return the friction on each channel, N·m or N."""
        return self.on_channels(self.friction(signals, values, constants), signals, constants)


class Sliding(NamedTuple):
    """From which velocity on an axis slides one way only.

    Attributes:
        velocity: in the unit of the velocity: half of what it changes by within a sample, or what it is known to.
        within_samples: whether what is slower passes through zero within a sample; at an instant it rests.
    """

    velocity: Value
    within_samples: bool


def sliding_of(signals: Signals, constants: Values, group: str = "") -> Sliding:
    """Return from which velocity on an axis slides: as each sample shows it where that is known, else at large.

    Args:
        signals: may have `sliding_velocity`, of the shape of the velocity.
        constants: have the one that holds at large.
        group: what both names begin with: a swerve's `drive_` or `steer_`.
    """
    name = f"{group}sliding_velocity"
    return Sliding(signals[name], True) if name in signals else Sliding(constants[name], False)


def fades(velocity: Real, fading_velocity: Value, slides: Sliding) -> bool:
    """Whether recorded velocities (...,) show friction of a level · exp(−(v / fading_velocity)²) fade.

    It has to be less at the fastest, and to be felt where samples tell the direction of motion, not only where an axis
    turns round within a sample. While it rests it says nothing of either.
    """
    fading = torch.exp(-((velocity / fading_velocity) ** 2))
    place = int(_FASTEST * (velocity.numel() - 1)) + 1
    fastest = velocity.abs().flatten().kthvalue(place).indices
    if slides.within_samples:
        resolution = torch.as_tensor(slides.velocity)
        slowest = torch.exp(-((resolution.min() / fading_velocity) ** 2))
        if slowest < _LEAST_KNOWN or not _is_told(velocity, fading, resolution):
            return False
    return bool(fading.flatten()[fastest] < _FADED)


def _is_told(velocity: Tensor, fading: Tensor, resolution: Tensor) -> bool:
    """Whether enough of what fades is felt in motion one way, beside what is where an axis turns round."""
    one_way = velocity.abs() > resolution
    turning = ~one_way & (resolution > resolution.min())  # what the sensor alone leaves open rests
    known = (fading * one_way).sum()
    return bool(known > _LEAST_KNOWN * (known + (fading * turning).sum()))


def dry_friction(
    level: Value,
    velocity: Real,
    applied: Real,
    slides: Sliding,
    backward_level: Value | None = None,
) -> Real:
    """Friction that opposes motion at its level, and at standstill what is applied, up to its level (...,).

    An axis that passes through zero within a sample slides one way and then the other: of its level there remains the
    share of time that the one exceeds the other by. The slower it is, and the less what is applied passes the level,
    the longer it is held.
    Source: Karnopp 1985, Computer simulation of stick-slip friction (ASME J. Dyn. Syst. 107).

    Args:
        level: N·m or N.
        velocity: (...,) rad/s or m/s; its mean where samples are meant.
        applied: what else acts, (...,) in the unit of the level.
        slides: from which velocity on.
        backward_level: against negative motion, where it is not the same as against positive.
    """
    level = torch.as_tensor(level, dtype=velocity.dtype)
    backward = level if backward_level is None else torch.as_tensor(backward_level, dtype=velocity.dtype)
    held = torch.maximum(torch.minimum(applied, level), -backward)
    speed = velocity / slides.velocity
    if slides.within_samples:
        return _over_samples(level, backward, speed, held, applied)
    return _at_an_instant(level, backward, speed, held)


def _at_an_instant(forward: Tensor, backward: Tensor, speed: Tensor, held: Tensor) -> Tensor:
    """Pass smoothly from what is held to what slides, as the speed (...,) in units of the sliding velocity grows."""
    slip = torch.tanh(speed)
    sliding = torch.where(slip > 0, forward, backward) * slip * slip.abs()
    return -sliding - (1.0 - slip.square()) * held


def _over_samples(forward: Tensor, backward: Tensor, speed: Tensor, held: Tensor, applied: Tensor) -> Tensor:
    """Return the mean of what slides one way and then the other, or rests for the share that it is held."""
    direction = speed.clamp(-1.0, 1.0)
    sliding = 0.5 * ((forward + backward) * direction + (forward - backward))
    share = held / torch.where(applied == 0.0, 1.0, applied)
    share = torch.where(applied == held, 1.0, share)
    resting = (1.0 - direction**_NOISY) * share
    return -(1.0 - resting) * sliding - resting * held
