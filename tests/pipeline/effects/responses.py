"""How a machine responds with one effect: the one way in which every kind of effect can be looked at."""

from collections.abc import Mapping
from typing import Any

import torch
from torch import Tensor

from simgap.effects import ActuatorEffect, Effect
from simgap.physics import rotations
from simgap.simulation import FittedEffect, Simulator
from tests.pipeline.platforms.machines import MACHINES

TIME_STEP = 0.0037  # s; no time in the catalogue is a multiple of it


def simulator_with(effect: Effect, values: Mapping[str, Any]) -> Simulator:
    return Simulator(MACHINES[effect.kind], (FittedEffect(effect, values),))


def response(effect: Effect, values: Mapping[str, Any], signals: Mapping[str, Tensor]) -> dict[str, Tensor]:
    """Return what a simulator with one effect says of blocks (blocks, samples, ...)."""
    return sides_of(simulator_with(effect, values), signals)


def sides_of(simulator: Simulator, signals: Mapping[str, Tensor]) -> dict[str, Tensor]:
    """Return both sides of the balance, and what readings have to be, for blocks (blocks, samples, ...)."""
    acting = simulator.along_time(signals, TIME_STEP)
    balance = simulator.balance(acting)
    sides = {side: getattr(balance, side) for side in ("momentum", "wrench", "rate")}
    readings = simulator.mechanism.readings(acting, simulator.constants())
    sides["reading"] = {channel: predicted for channel, (_, predicted) in readings.items()}
    return {f"{side} {channel}": value for side, parts in sides.items() for channel, value in parts.items()}


def actuated(kind: str, signals: Mapping[str, Tensor]) -> dict[str, Tensor]:
    """Return the signals with the nominal actuator's output added."""
    mechanism = Simulator(MACHINES[kind]).mechanism
    return mechanism.actuate(signals, mechanism.constants())


def with_hidden(
    effect: Effect, signals: Mapping[str, Tensor], values: Mapping[str, Any]
) -> dict[str, Tensor]:
    """Return signals (samples, ...) with those that an effect adds itself and its wrench reads."""
    if not isinstance(effect, ActuatorEffect):
        return dict(signals)
    block = {name: series[None] for name, series in signals.items()}
    acted = effect.along_time(block, values, constants(effect.kind), TIME_STEP)
    return {name: series[0] for name, series in acted.items()}


def constants(kind: str) -> dict[str, Any]:
    return Simulator(MACHINES[kind]).constants()


def sample_by_sample(
    effect: ActuatorEffect, signals: Mapping[str, Tensor], values: Mapping[str, Any], time_step: float
) -> dict[str, Tensor]:
    """Return what an effect changes when it is given one sample of the blocks after the other."""
    memory, steps = None, []
    for sample in range(next(iter(signals.values())).shape[1]):
        now = {name: series[:, sample] for name, series in signals.items()}
        changed, memory = effect.actuate(now, values, constants(effect.kind), memory, time_step)
        steps.append(changed)
    return {name: torch.stack([changed[name] for changed in steps], dim=1) for name in steps[0]}


def smooth_flight(samples: int, duration: float) -> dict[str, Tensor]:
    """Return one block of a quadrotor that is swung through the air from rest, the same flight at any rate."""
    time = torch.linspace(0.0, duration, samples + 1, dtype=torch.float64)[None, :, None]
    swing = torch.sin(torch.tensor([5.0, 7.0, 3.0], dtype=torch.float64) * time) ** 3
    attitude = rotations.from_rotation_vector(0.5 * swing)
    speed = 1000.0 + 200.0 * torch.sin(torch.tensor([5.0, 7.0, 9.0, 11.0], dtype=torch.float64) * time)
    return {
        "position": torch.zeros_like(swing),
        "attitude": attitude,
        "velocity": rotations.rotate_inverse(attitude, 2.0 * swing.flip(-1)),
        "body_rate": torch.zeros_like(swing),
        "rotor_speed": speed,
    }


def smooth_swing(samples: int, duration: float) -> dict[str, Tensor]:
    """Return one block of a joint that swings from rest, the same motion at any rate."""
    time = torch.linspace(0.0, duration, samples + 1, dtype=torch.float64)[None]
    sine, cosine = torch.sin(5.0 * time), torch.cos(5.0 * time)
    return {"position": sine**3, "velocity": 15.0 * sine**2 * cosine, "effort": torch.sin(7.0 * time) ** 3}


def telling_values(effect: Effect) -> list[dict[str, float]]:
    """Return values at which the effect acts: its default and the starts of its scan that are not neutral."""
    starts = [start for start in effect.starts() if start != effect.neutral()]
    return [effect.defaults(), *starts]


def assert_same(first: Mapping[str, Tensor], second: Mapping[str, Tensor], rtol: float = 1e-12) -> None:
    assert first.keys() == second.keys()
    for name, value in first.items():
        size = float(value.detach().abs().max()) if value.numel() else 0.0
        torch.testing.assert_close(value, second[name], rtol=rtol, atol=rtol * max(size, 1e-9), msg=name)


def numbers(*values: float) -> Tensor:
    """Return a signal of these values, (values,)."""
    return torch.tensor(values, dtype=torch.float64)
