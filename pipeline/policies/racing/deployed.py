"""Machines that are no simulator's, flown by the flight controller that the simulator has."""

from collections.abc import Callable
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from pipeline.platforms import Quadrotor
from pipeline.policies.racing.flying import PARTS
from pipeline.simulation.controllers import Betaflight

Array = NDArray[Any]
Fly = Callable[[Array, Array], Array]
"""From states (batch, 13) as such machines have them and references (batch, 4) to the states a period later."""

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
    """The machines as a race has them, see `pipeline.policies.racing.flying.Flown`; a critic is told nothing here."""

    def __init__(self, fly: Fly) -> None:
        self._fly = fly

    def rows(self, state: Tensor) -> Tensor:
        """Return states (batch, 13) as rows; what else such a machine remembers is its own affair."""
        return state.T.float().contiguous()

    def step(self, rows: Tensor, command: Tensor, further: Tensor | None = None) -> Tensor:
        """Return the rows a period later; nothing further acts on such machines than what does."""
        theirs = np.concatenate([rows[PARTS[name]].T.double().numpy() for name in _THEIRS], axis=1)
        after = torch.from_numpy(self._fly(theirs, command.double().numpy())).to(rows)
        sizes = [PARTS[name].stop - PARTS[name].start for name in _THEIRS]
        flown = torch.empty_like(rows)
        for name, part in zip(_THEIRS, after.split(sizes, dim=1), strict=True):
            flown[PARTS[name]] = part.T
        return flown

    def angular_acceleration(self, rows: Tensor) -> Tensor:
        """Return zeros (batch, 3): it is not measured."""
        return torch.zeros_like(rows[:3].T)
