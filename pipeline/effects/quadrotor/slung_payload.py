"""A load that swings below the machine on a cable."""

from dataclasses import dataclass
from typing import Any

import torch
from torch import Tensor

from pipeline.effects.chain import chains_of
from pipeline.effects.effect import ActuatorEffect, Parameter, Signals, Values, WrenchEffect
from pipeline.effects.quadrotor.common import along_axes
from pipeline.effects.scan import scan
from pipeline.physics import rotations

_FINE, _COARSE = (
    0.04,
    0.15,
)  # rad that a cable swings by in a step: where it counts, and where its start is looked for
_TOGETHER = 4  # stretches through which a swing is followed: what is felt is no more precise than that
_USUAL = 0.3  # rad, by which a cable may be off the apparent gravity at first
_CORRECTIONS = 2
_SLIGHT = 1e-3  # rad, by which it is turned to see what that changes
_MEMORY = 0.2  # s, after which what is felt tells something new


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

        An accelerometer reads it where there is one, else velocities give it by central differences. Nothing stops a
        load from swinging on from stretch to stretch; how it swings at the first is what the forces across the thrust
        say.
        """
        chains = chains_of(signals, time_step, _TOGETHER)
        apparent = _apparent_gravity(signals, constants, time_step)
        joined = chains.joined(apparent)
        cable = Cable(values["length"], constants["gravity"], time_step)
        start = _along(joined[:, 0]), torch.zeros_like(joined[:, 0])
        if "run_number" in signals:
            attitude = chains.joined(signals["attitude"])
            start = _first_swing(cable, start, joined, attitude, ~chains.ended, values["mass_ratio"])
        direction, rate = (chains.parted(series) for series in cable.swings(*start, joined))
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


@dataclass(frozen=True)
class Cable:
    """A cable whose upper end moves as recorded.

    Attributes:
        length: m.
        gravity: m/s².
        time_step: of the recording, s.
    """

    length: Tensor | float
    gravity: float
    time_step: float

    @property
    def pace(self) -> Tensor:
        """How fast it swings, rad/s."""
        return (self.gravity / torch.as_tensor(self.length, dtype=torch.float64)).sqrt()

    def stride(self, turn: float) -> int:
        """Return how many samples are a step in which it swings by an angle in rad, at least one."""
        return max(int(turn / float(self.pace) / self.time_step), 1)

    def swings(self, direction: Tensor, rate: Tensor, apparent: Tensor) -> tuple[Tensor, Tensor]:
        """Return direction and rate of cables along samples of apparent gravity (cables, samples, 3) from a start.

        A step is as many samples as make a small part of a swing, over the mean of what acts; in between, both change
        linearly.
        """
        stride = self.stride(_FINE)
        found = self.steps(direction, rate, _pooled(apparent, stride), stride)
        direction, rate = (_spread(series, stride, apparent.shape[1]) for series in found)
        return _along(direction), rate

    def steps(self, direction: Tensor, rate: Tensor, means: Tensor, stride: int) -> tuple[Tensor, Tensor]:
        """Return direction and rate of cables over steps of so many samples, (cables, steps, 3) each."""
        directions, rates = [direction], [rate]
        for before, after in zip(means[:, :-1].unbind(1), means[:, 1:].unbind(1), strict=True):
            direction, rate = _swing(direction, rate, before, after, self.length, stride * self.time_step)
            directions.append(direction)
            rates.append(rate)
        return torch.stack(directions, 1), torch.stack(rates, 1)


def _first_swing(
    cable: Cable,
    rest: tuple[Tensor, Tensor],
    apparent: Tensor,
    attitude: Tensor,
    counts: Tensor,
    mass_ratio: Tensor | float,
) -> tuple[Tensor, Tensor]:
    """Return direction and rate with which the pull follows best what is felt across the thrust.

    Gauss-Newton from rest, in coarse steps, over two angles and their rates, as far as they may usually be off.

    Args:
        cable: that swings.
        rest: direction and rate, (cables, 3).
        apparent: gravity, world frame, (cables, samples, 3) m/s².
        attitude: (cables, samples, 4).
        counts: which samples count, (cables, samples).
        mass_ratio: of load and machine.
    """
    stride = cable.stride(_COARSE)
    means = _pooled(apparent, stride)
    middles = (stride * torch.arange(means.shape[1]) + stride // 2).clamp_max(apparent.shape[1] - 1)
    attitude, counts = attitude[:, middles], counts[:, middles]
    felt = _across_thrust(attitude, -means, counts)
    independent = counts.sum(1) * stride * cable.time_step / _MEMORY
    units = torch.eye(4, dtype=felt.dtype)
    off = torch.zeros(len(felt), 4, dtype=felt.dtype)
    for _ in range(_CORRECTIONS):
        moved = [off, *(off + _SLIGHT * unit for unit in units)]
        starts = zip(*(_turned(cable, rest, each) for each in moved), strict=True)
        direction, rate = (torch.cat(part) for part in starts)
        whole = means.repeat(len(moved), 1, 1)
        swung = cable.steps(direction, rate, whole, stride)
        pulls = (mass_ratio * _pull(*swung, whole, cable.length)).unflatten(0, (len(moved), -1))
        shown = torch.stack([_across_thrust(attitude, pull, counts) for pull in pulls])
        slopes, error = ((shown[1:] - shown[0]) / _SLIGHT).movedim(0, -1), felt - shown[0]
        weight = independent / error.square().sum(1).clamp_min(1e-12)
        square = weight[:, None, None] * slopes.mT @ slopes + units / _USUAL**2
        uphill = weight[:, None] * (slopes.mT @ error[..., None])[..., 0] - off / _USUAL**2
        off = off + torch.linalg.solve(square, uphill)
    return _turned(cable, rest, off)


def _turned(cable: Cable, rest: tuple[Tensor, Tensor], off: Tensor) -> tuple[Tensor, Tensor]:
    """Return direction and rate of cables off rest by two angles, and by two rates over their pace, (cables, 4)."""
    direction, rate = rest
    sides = torch.stack(
        [_across(axis.expand_as(direction), direction) for axis in torch.eye(3).to(direction)[:2]]
    )
    aside, turning = ((part.T[..., None] * sides).sum(0) for part in (off[:, :2], cable.pace * off[:, 2:]))
    turned = _along(direction + aside)
    return turned, _across(rate + turning, turned)


def _across_thrust(attitude: Tensor, acceleration: Tensor, counts: Tensor) -> Tensor:
    """Return accelerations (cables, samples, 3), world frame, along body x and y; 0 where they do not count."""
    return (rotations.rotate_inverse(attitude, acceleration)[..., :2] * counts[..., None]).flatten(1)


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
    """Return direction and rate of the cable a step later.

    Source: Hairer, Lubich & Wanner 2006, Geometric numerical integration, §VII.1.4: RATTLE, second order.

    Args:
        direction: of the cable away from the machine, unit, (..., 3).
        rate: of the direction, across it, (..., 3) 1/s.
        before: apparent gravity at the start of the step, (..., 3) m/s².
        after: at its end.
        length: of the cable, m.
        time_step: s.
    """
    kick = 0.5 * time_step / length
    free = direction + time_step * (rate + kick * before)
    along, size = (free * direction).sum(-1, keepdim=True), (free * free).sum(-1, keepdim=True)
    turned = free + ((along * along - size + 1.0).clamp_min(0.0).sqrt() - along) * direction
    return turned, _across((turned - direction) / time_step + kick * after, turned)


def _across(vector: Tensor, direction: Tensor) -> Tensor:
    return vector - (vector * direction).sum(-1, keepdim=True) * direction


def _pull(direction: Tensor, rate: Tensor, apparent: Tensor, length: Tensor | float) -> Tensor:
    """Return the cable's tension per mass of the load along its direction, m/s²; a cable does not push."""
    tension = length * rate.square().sum(-1) + (direction * apparent).sum(-1)
    return tension.clamp_min(0.0)[..., None] * direction
