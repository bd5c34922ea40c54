"""The resolution of a recording: the slowest motion with a known direction, and the shortest delay."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import torch
from torch import Tensor

from simgap.equations.encoder import encoder_step, resting
from simgap.equations.sample_noise import sample_noise
from simgap.simulation import Simulator
from simgap.simulation.blocks import Blocks

_POSITIONS = {"sliding_velocity": "position", "steer_sliding_velocity": "steer_angle"}
"""The signal whose rate of change a velocity is, by the name of the sliding-velocity setting."""
_LEAST_CHANGES = 0.05  # quantile of the changes of a velocity that estimates its quantum
_CROSSED = 0.5  # of the change of velocity per step; below it, the velocity passes zero within the step
_MOST_CHANGES = 10_000_000  # most values for a quantile
_CERTAIN = 3.0  # standard deviations of the noise, above which the direction is known
_LEAST_SHARE, _LEAST_SPEED = 1e-3, 1e-6  # of the RMS speed, and in its unit: limits of the resolution
_HOLDING = 0.5  # of a sample, by which holding delays a command
_SHORT = 0.3  # of a sample; a controller twice as fast as the log is already a quarter of a sample off


def is_short(late: float, time_step: float, held: bool) -> bool:
    """Whether a delay, s, is too short to be told from the timing of the commands.

    A command that is held to the next sample acts half a sample late on average. Taken for measured at the sample, it
    looks late by as much, and a measured one that is taken for held looks early.

    Args:
        late: how late a command acts beyond what is assumed.
        time_step: between samples, s.
        held: whether commands are taken to be held.
    """
    samples = late / time_step
    return late != 0.0 and (-_SHORT - _HOLDING * held < samples < _SHORT + _HOLDING * (not held))


def resolved(nominal: Simulator, blocks: Blocks) -> Simulator:
    """Set the speeds below which the recording cannot tell the direction of motion."""
    found = {
        name: _resolution(blocks.inner(velocity), blocks.on_steps)
        for name, velocity in _sliding_velocities(nominal, blocks.signals).items()
    }
    return replace(nominal, settings={**found, **nominal.settings})


@dataclass(frozen=True)
class Sensors:
    """What the sensors of an axis resolve.

    Attributes:
        velocity: the slowest one whose direction shows, rad/s or m/s.
        step: of the encoder, rad or m; 0 where the position shows none, or was not recorded.
    """

    velocity: float
    step: float


def with_resolution(blocks: Blocks, nominal: Simulator, known_to: Mapping[str, Sensors]) -> Blocks:
    """Add the velocity below which the direction of motion is unknown, for each sample, and where an axis rests.

    That velocity is the resolution of the sensor, or half of the change of velocity per sample if that is more. An axis
    that stays within a step of its encoder rests, however fast that step makes it look.
    """
    resolution = {}
    for name, velocity in _sliding_velocities(nominal, blocks.signals).items():
        sensors = known_to[name]
        change = torch.gradient(velocity, dim=1)[0].abs()
        resolution[name] = (_CROSSED * change).clamp_min(sensors.velocity)
        if sensors.step > 0.0:
            rests = resting(blocks.signals[_POSITIONS[name]], sensors.step, blocks.time_step)
            resolution[name.replace("sliding_velocity", "resting")] = rests.to(velocity.dtype)
    return replace(blocks, resolution=resolution)


def resolution_of(nominal: Simulator, blocks: Blocks) -> dict[str, Sensors]:
    """Return what the sensors resolve, by the name of the sliding-velocity setting."""
    known = {}
    for name, velocity in _sliding_velocities(nominal, blocks.signals).items():
        inner = blocks.inner(velocity)
        per_axis = inner.flatten(2).transpose(1, 2).flatten(0, 1) if inner.ndim > 2 else inner
        noise = _CERTAIN * float(sample_noise(per_axis, blocks.noise_kept)) ** 0.5
        slowest = max(noise, _quantum(inner), _LEAST_SHARE * _usual(inner), _LEAST_SPEED)
        position = blocks.signals.get(_POSITIONS.get(name, ""))
        known[name] = Sensors(slowest, 0.0 if position is None else encoder_step(position))
    return known


def _sliding_velocities(nominal: Simulator, signals: dict[str, Tensor]) -> dict[str, Tensor]:
    """Return the sliding velocities, by the name of the sliding-velocity setting."""
    if nominal.platform.kind == "joint":
        return {"sliding_velocity": signals["velocity"]}
    if nominal.platform.kind == "swerve":
        return {
            "drive_sliding_velocity": signals["drive_velocity"] / nominal.constants()["drive_gear_ratio"],
            "steer_sliding_velocity": signals["steer_velocity"],
        }
    return {}


def _resolution(velocity: Tensor, on_steps: bool) -> float:
    """Return the speed below which a recorded velocity (blocks, samples, ...) leaves its sign open."""
    jitter = float(velocity.diff(dim=1).square().median().sqrt()) * (_CROSSED if on_steps else 1.0)
    return max(0.01 * _usual(velocity), jitter, _quantum(velocity), _LEAST_SPEED)


def _usual(velocity: Tensor) -> float:
    return float(velocity.square().mean().sqrt())


def _quantum(velocity: Tensor) -> float:
    """Return the step of a velocity's sensor, or less where it has none."""
    changes = velocity.diff(dim=1).abs()
    moved = changes[changes > 1e-9 * max(_usual(velocity), 1e-12)]
    return float(moved.quantile(_LEAST_CHANGES)) if 0 < len(moved) < _MOST_CHANGES else 0.0
