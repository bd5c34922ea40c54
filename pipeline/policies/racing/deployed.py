"""Races of machines outside a simulator, with the simulator's flight controller."""

from collections.abc import Callable
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from simgap.platforms import Quadrotor
from simgap.policies.racing.flying import PARTS, STATE
from simgap.simulation.controllers import Betaflight

Array = NDArray[Any]
Fly = Callable[[Array, Array], tuple[Array, Array]]
"""From states (batch, 13) as such machines have them and references (batch, 4) to the states a period later, and to
what the machines believe them to be."""

_THEIRS = ("position", "velocity", "attitude", "body_rate")  # the order of their states


class RateLoop:
    """Betaflight's rate controller, for machines that ask it step by step.

    Args:
        platform: that the controller is tuned for.
        time_constant: of the motors, s, that it is tuned for.
        step: from one call to the next, s.
    """

    def __init__(self, platform: Quadrotor, time_constant: float, step: float) -> None:
        self._controller = Betaflight.tuned(platform, time_constant)
        self._most, self._step = platform.motor_speed_max, step
        self._memory: dict[str, Tensor] | None = None

    def __call__(self, body_rate: Array, reference: Array) -> Array:
        """Return commanded rotor speeds (batch, 4), rad/s.

        Args:
            body_rate: measured, (batch, 3) rad/s.
            reference: collective thrust over mass and body rates, (batch, 4) m/s² and rad/s.
        """
        rate, wanted = torch.from_numpy(body_rate), torch.from_numpy(reference)
        throttle, self._memory = self._controller.command(rate, wanted, self._memory, self._step)
        return self._most * throttle.numpy()


class Deployed:
    """The machines as a race has them, see `simgap.policies.racing.flying.Flown`; a critic is told nothing here.

    Their rows are their states and, below them, what they believe of them.
    """

    def __init__(self, fly: Fly) -> None:
        self._fly = fly

    def rows(self, state: Tensor) -> Tensor:
        """Return states (batch, 13) as rows; what else such a machine remembers is its own affair."""
        state = state.T.float()
        return torch.cat([state, state])

    def step(self, rows: Tensor, command: Tensor, further: Tensor | None = None) -> Tensor:
        """Return the rows a period later; nothing further acts on such machines than what does."""
        theirs = np.concatenate([rows[PARTS[name]].T.double().numpy() for name in _THEIRS], axis=1)
        flown = self._fly(theirs, command.double().numpy())
        return torch.cat([_ours(part).to(rows) for part in flown])

    def believed(self, rows: Tensor) -> Tensor:
        """Return the states as the machines believe them to be, (13, batch)."""
        return rows[STATE:]

    def angular_acceleration(self, rows: Tensor) -> Tensor:
        """Return zeros (batch, 3): it is not measured."""
        return torch.zeros_like(rows[:3].T)


def _ours(states: Array) -> Tensor:
    """Return states (batch, 13) in the order of ours, as rows."""
    sizes = [PARTS[name].stop - PARTS[name].start for name in _THEIRS]
    ours = torch.empty(STATE, len(states), dtype=torch.float64)
    for name, part in zip(_THEIRS, torch.from_numpy(states).split(sizes, dim=1), strict=True):
        ours[PARTS[name]] = part.T
    return ours
