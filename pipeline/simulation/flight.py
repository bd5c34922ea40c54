"""A simulated quadrotor with its rate controller, as a policy commands it."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import torch
from jaxtyping import Float
from torch import Tensor

from simgap.platforms import Quadrotor
from simgap.simulation.controllers import Betaflight
from simgap.simulation.knn_residual import HeldResidual, residual_features
from simgap.simulation.motion import QuadrotorMotion
from simgap.simulation.powertrain import Powertrain, powertrain_values
from simgap.simulation.rollout import step
from simgap.simulation.simulator import FittedEffect, Simulator

_BODY_RATE_PART = QuadrotorMotion.parts["body_rate"]

Memory = tuple[Any, Any]
"""Of the controller and of the simulator's effects."""

Residual = Callable[[Float[Tensor, "batch 7"]], Float[Tensor, "batch 6"]]
"""From `residual_features` to specific force, m/s², and torque, N·m, (batch, 6)."""


@dataclass(frozen=True)
class Flight:
    """Actions at one rate, rate controller and physics at another.

    Attributes:
        simulator: a quadrotor with its effects.
        controller: runs at every inner step, as on the machine.
        period: between two actions, s.
        substeps: inner steps in a period.
        integrator: of the inner steps, see `simgap.simulation.rollout.step`.
        residual: what the physics leaves over, looked up once in a period and held through it.
    """

    simulator: Simulator
    controller: Betaflight
    period: float = 0.01
    substeps: int = 5
    integrator: str = "rk4"
    residual: Residual | None = None

    def step(
        self, state: Float[Tensor, "batch 13"], action: Float[Tensor, "batch 4"], memory: Memory | None = None
    ) -> tuple[Float[Tensor, "batch 13"], Memory]:
        """Advance a batch by one action.

        Args:
            state: (batch, 13), see `simgap.simulation.motion.QuadrotorMotion`.
            action: collective thrust over mass and body rates, (batch, 4) m/s² and rad/s, held through the period.
            memory: of the period before; None before the first.

        Returns:
            The state at the period's end and the memory for the next.
        """
        acting = self.acting(state, action)
        for _ in range(self.substeps):
            state, memory = self.inner_step(state, acting, memory)
        assert memory is not None
        return state, memory

    def acting(
        self, state: Float[Tensor, "batch 13"], action: Float[Tensor, "batch 4"]
    ) -> Float[Tensor, "batch acting"]:
        """Return the action, followed by the residual force and torque where there is a residual, (batch, 4 or 10)."""
        if self.residual is None:
            return action
        signals = QuadrotorMotion().signals(state)
        features = residual_features(signals["velocity"], signals["body_rate"], action)
        return torch.cat([action, self.residual(features)], dim=-1)

    def inner_step(
        self, state: Float[Tensor, "batch 13"], acting: Float[Tensor, "batch acting"], memory: Memory | None
    ) -> tuple[Float[Tensor, "batch 13"], Memory]:
        """Advance a batch by one inner step with what `acting` returned at the start of the period."""
        regulating, effects = memory or (None, ())
        inner = self.period / self.substeps
        throttle, regulating = self.controller.command(
            state[..., _BODY_RATE_PART], acting[..., :4], regulating, inner
        )
        command = {"motor_command": throttle}
        if self.residual is not None:
            command["residual"] = acting[..., 4:]
        state, effects = step(self.simulator, state, command, inner, effects, integrator=self.integrator)
        return state, (regulating, effects)


def racing_flight(
    platform: Quadrotor,
    effects: tuple[FittedEffect, ...] = (),
    time_constant: float = 0.033,
    drive: Mapping[str, float] | None = None,
    residual: Residual | None = None,
    **options: Any,
) -> Flight:
    """Return a quadrotor with powertrain and rate controller.

    Args:
        platform: the racer, or any other quadrotor.
        effects: further physics, for example of the catalogue.
        time_constant: of the motors, s, for which the controller is tuned.
        drive: values of the powertrain other than those of `powertrain_values` (another battery, say).
        residual: force (m/s²) and torque (N·m) by `residual_features`.
        options: `period`, `substeps` and `integrator` of the flight.
    """
    values = powertrain_values(platform, time_constant=time_constant) | dict(drive or {})
    powertrain = FittedEffect(Powertrain(), values, known=True)
    controller = Betaflight.tuned(platform, time_constant)
    held = () if residual is None else (FittedEffect(HeldResidual(), {}, known=True),)
    return Flight(
        Simulator(platform, (powertrain, *effects, *held)), controller, residual=residual, **options
    )
