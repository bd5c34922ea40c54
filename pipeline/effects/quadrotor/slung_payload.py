"""A load that swings below the machine on a cable."""

import math
from typing import Any

import torch
from torch import Tensor

from pipeline.effects.chain import chains_of
from pipeline.effects.effect import ActuatorEffect, Parameter, Signals, Values, WrenchEffect
from pipeline.effects.quadrotor.common import along_axes
from pipeline.effects.scan import scan
from pipeline.physics import rotations

_STEP = 0.04  # of the time in which a cable swings by a rad
_STILL = 1e-12  # rad, below which a cable has not turned


class SlungPayload(ActuatorEffect, WrenchEffect):
    """A point mass on a light taut cable from the centre of mass, free to swing in every direction."""

    remembers = True
    linear = False
    order = 3
    name = "slung_payload"
    kind = "quadrotor"
    acts_on = "force"
    parameters = (
        Parameter("mass_ratio", "1", 0.1, 0.0, 1.0),
        Parameter("length", "m", 0.8, 0.1, 5.0, neutral=1.0),
    )
    needs = ("attitude", "velocity")
    formula = (
        "with q the cable's direction and b = g − dv/dt the apparent gravity: length·d²q/dt² = b − (q·b)·q − "
        "length·|dq/dt|²·q; a = mass_ratio · max(length·|dq/dt|² + q·b, 0) · q"
    )
    source = (
        "Sreenath, Michael & Kumar 2013, Trajectory generation and control of a quadrotor with a cable-suspended "
        "load, §II"
    )
    sentence = (
        "A load of {mass_ratio} times the machine's mass swings on a cable of {length} m; add the pendulum to the "
        "simulator."
    )
    excitation = "dash and stop, and wait for several swings"

    def starts(self) -> list[dict[str, float]]:
        """Start from a scan over the length: each swing that is gained or lost is a valley."""
        return scan(mass_ratio=(0.05,), length=(0.15, 0.25, 0.4, 0.6, 0.9, 1.4, 2.2, 3.5))

    def actuate(
        self, signals: Signals, values: Values, constants: Values, memory: Any, time_step: float
    ) -> tuple[dict[str, Tensor], Any]:
        """Return the cable's pull per mass of the load; hanging straight at the first sample.

        The memory holds direction and rate of the cable, the machine's velocity and the pull, all in the world frame.
        The pull was part of the acceleration since; without it, the rest is shared between machine and load.
        """
        velocity = rotations.rotate(signals["attitude"], signals["velocity"])
        weight = _weight(velocity, constants)
        if memory is None:
            direction, rate = _along(weight), torch.zeros_like(weight)
            bare = apparent = weight
            share = 1.0
        else:
            direction, rate, before, pull = memory
            apparent = weight - (velocity - before) / time_step
            bare = apparent + values["mass_ratio"] * pull
            share = 1.0 / (1.0 + values["mass_ratio"])
            direction, rate = _swing(direction, rate, apparent, apparent, values["length"], time_step)
        pull = share * _pull(direction, rate, bare, values["length"])
        return {"payload_pull": pull}, (direction, rate, velocity, pull)

    def along_time(
        self, signals: Signals, values: Values, constants: Values, time_step: float
    ) -> dict[str, Tensor]:
        """Return recorded blocks with the pull that follows from how the machine was seen to accelerate.

        An accelerometer reads it where there is one, else velocities give it by central differences. The cable starts
        along the apparent gravity where a recording does, and swings on from stretch to stretch: nothing stops it.
        """
        chains = chains_of(signals, time_step)
        apparent = _apparent_gravity(signals, constants, time_step)
        swung = _swings(chains.joined(apparent), values["length"], constants["gravity"], time_step)
        direction, rate = (chains.parted(series) for series in swung)
        return {**signals, "payload_pull": _pull(direction, rate, apparent, values["length"])}

    def wrench(self, signals: Signals, values: Values, constants: Values) -> dict[str, Tensor]:
        """Return the cable's pull on the machine in the body frame, m/s²."""
        pull = rotations.rotate_inverse(signals["attitude"], signals["payload_pull"])
        return along_axes("force", values["mass_ratio"] * pull)


def _weight(like: Tensor, constants: Values) -> Tensor:
    down = torch.zeros_like(like)
    down[..., 2] = -constants["gravity"]
    return down


def _apparent_gravity(signals: Signals, constants: Values, time_step: float) -> Tensor:
    """Return gravity less the machine's acceleration along blocks, world frame (blocks, samples, 3), m/s²."""
    if "specific_force" in signals:
        return -rotations.rotate(signals["attitude"], signals["specific_force"])
    velocity = rotations.rotate(signals["attitude"], signals["velocity"])
    (acceleration,) = torch.gradient(velocity, spacing=time_step, dim=1)
    return _weight(velocity, constants) - acceleration


def _along(vector: Tensor) -> Tensor:
    """Return the direction of vectors (..., 3); straight down where there is none."""
    down = torch.zeros_like(vector)
    down[..., 2] = -1.0
    size = torch.linalg.vector_norm(vector.detach(), dim=-1, keepdim=True)
    safe = torch.where(size > 0.0, vector, down)
    return safe / torch.linalg.vector_norm(safe, dim=-1, keepdim=True)


def _swings(
    apparent: Tensor, length: Tensor | float, gravity: float, time_step: float
) -> tuple[Tensor, Tensor]:
    """Return direction and rate of cables that hang at the first of samples (cables, samples, 3).

    A step is as many samples as make a small part of a swing, over the mean of what acts; in between, both change
    linearly.
    """
    stride = max(int(_STEP * math.sqrt(float(length) / gravity) / time_step), 1)
    means = _pooled(apparent, stride)
    direction, rate = _along(apparent[:, 0]), torch.zeros_like(apparent[:, 0])
    directions, rates = [direction], [rate]
    for before, after in zip(means[:, :-1].unbind(1), means[:, 1:].unbind(1), strict=True):
        direction, rate = _swing(direction, rate, before, after, length, stride * time_step)
        directions.append(direction)
        rates.append(rate)
    found = (torch.stack(series, 1) for series in (directions, rates))
    direction, rate = (_spread(series, stride, apparent.shape[1]) for series in found)
    return _along(direction), rate


def _pooled(series: Tensor, stride: int) -> Tensor:
    """Return the means of every so many samples of a series (cables, samples, 3), the last one held where it ends."""
    missing = -series.shape[1] % stride
    whole = torch.cat([series, series[:, -1:].expand(-1, missing, -1)], dim=1)
    return whole.unflatten(1, (-1, stride)).mean(2)


def _spread(series: Tensor, stride: int, samples: int) -> Tensor:
    """Return a series (cables, steps, 3) of the middles of steps at every sample, (cables, samples, 3)."""
    if stride == 1:
        return series
    linear = torch.nn.functional.interpolate(series.transpose(1, 2), scale_factor=stride, mode="linear")
    return linear.transpose(1, 2)[:, :samples]


def _swing(
    direction: Tensor, rate: Tensor, before: Tensor, after: Tensor, length: Tensor | float, time_step: float
) -> tuple[Tensor, Tensor]:
    """Return direction and rate of the cable a step later: kick, turn along a great circle, kick.

    Source: Hairer, Lubich & Wanner 2006, Geometric numerical integration, §VII.1.4: RATTLE on the sphere, second order.

    Args:
        direction: of the cable away from the machine, unit, (..., 3).
        rate: of the direction, across it, (..., 3) 1/s.
        before: apparent gravity at the start of the step, (..., 3) m/s².
        after: at its end.
        length: of the cable, m.
        time_step: s.
    """
    kick = 0.5 * time_step / length
    rate = rate + kick * _across(before, direction)
    angle = ((rate * time_step).square().sum(-1, keepdim=True) + _STILL**2).sqrt()
    sine = torch.sin(angle) / angle
    turned = torch.cos(angle) * direction + time_step * sine * rate
    rate = torch.cos(angle) * rate - sine * angle.square() / time_step * direction
    return turned, rate + kick * _across(after, turned)


def _across(vector: Tensor, direction: Tensor) -> Tensor:
    return vector - (vector * direction).sum(-1, keepdim=True) * direction


def _pull(direction: Tensor, rate: Tensor, apparent: Tensor, length: Tensor | float) -> Tensor:
    """Return the cable's tension per mass of the load along its direction, m/s²; a cable does not push."""
    tension = length * rate.square().sum(-1) + (direction * apparent).sum(-1)
    return tension.clamp_min(0.0)[..., None] * direction
