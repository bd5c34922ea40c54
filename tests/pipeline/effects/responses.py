"""How a machine responds with one effect: the one way in which every kind of effect can be looked at."""

from collections.abc import Mapping
from typing import Any

import torch
from torch import Tensor

from pipeline.effects import Effect
from pipeline.simulation import FittedEffect, Simulator
from tests.pipeline.platforms.machines import MACHINES

TIME_STEP = 0.0037  # s; no time in the catalogue is a multiple of it


def simulator_with(effect: Effect, values: Mapping[str, Any]) -> Simulator:
    return Simulator(MACHINES[effect.kind], (FittedEffect(effect, values),))


def response(effect: Effect, values: Mapping[str, Any], signals: Mapping[str, Tensor]) -> dict[str, Tensor]:
    """Return both sides of the balance for blocks (blocks, samples, ...), with one effect."""
    simulator = simulator_with(effect, values)
    balance = simulator.balance(simulator.along_time(signals, TIME_STEP))
    return {
        f"{side} {channel}": value
        for side in ("momentum", "wrench", "rate")
        for channel, value in getattr(balance, side).items()
    }


def actuated(kind: str, signals: Mapping[str, Tensor]) -> dict[str, Tensor]:
    """Return the signals with the nominal actuator's output added."""
    mechanism = Simulator(MACHINES[kind]).mechanism
    return mechanism.actuate(signals, mechanism.constants())


def constants(kind: str) -> dict[str, Any]:
    return Simulator(MACHINES[kind]).constants()


def telling_values(effect: Effect) -> list[dict[str, float]]:
    """Return values at which the effect acts: its default and the starts of its scan that are not neutral."""
    starts = [start for start in effect.starts() if start != effect.neutral()]
    return [effect.defaults(), *starts]


def assert_same(first: Mapping[str, Tensor], second: Mapping[str, Tensor], rtol: float = 1e-12) -> None:
    assert first.keys() == second.keys()
    for name, value in first.items():
        size = float(value.detach().abs().max()) if value.numel() else 0.0
        torch.testing.assert_close(value, second[name], rtol=rtol, atol=rtol * max(size, 1e-9), msg=name)
