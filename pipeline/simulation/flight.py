"""A simulated quadrotor with its rate controller in front: what a policy flies."""

from dataclasses import dataclass
from typing import Any

from torch import Tensor

from pipeline.platforms import Quadrotor
from pipeline.simulation.controllers import Betaflight
from pipeline.simulation.motion import QuadrotorMotion
from pipeline.simulation.powertrain import Powertrain, powertrain_values
from pipeline.simulation.rollout import step
from pipeline.simulation.simulator import FittedEffect, Simulator

_RATE = QuadrotorMotion.parts["body_rate"]

Memory = tuple[Any, Any]
"""Of the controller and of the simulator's effects."""


@dataclass(frozen=True)
class Flight:
    """Actions at one rate, rate controller and physics at another.

    Attributes:
        simulator: a quadrotor with its effects.
        controller: runs at every inner step, as on the machine.
        period: between two actions, s.
        substeps: inner steps in a period.
        integrator: of the inner steps, see `pipeline.simulation.rollout.step`.
    """

    simulator: Simulator
    controller: Betaflight
    period: float = 0.01
    substeps: int = 5
    integrator: str = "rk4"

    def step(self, state: Tensor, action: Tensor, memory: Memory | None = None) -> tuple[Tensor, Memory]:
        """Advance a batch by one action.

        Args:
            state: (..., 13), see `pipeline.simulation.motion.QuadrotorMotion`.
            action: collective thrust over mass and body rates, (..., 4) m/s² and rad/s, held through the period.
            memory: of the period before; None before the first.

        Returns:
            The state at the period's end and the memory for the next.
        """
        regulating, effects = memory or (None, ())
        inner = self.period / self.substeps
        for _ in range(self.substeps):
            throttle, regulating = self.controller.command(state[..., _RATE], action, regulating, inner)
            state, effects = step(
                self.simulator,
                state,
                {"motor_command": throttle},
                inner,
                effects,
                integrator=self.integrator,
            )
        return state, (regulating, effects)


def racing_flight(
    platform: Quadrotor, effects: tuple[FittedEffect, ...] = (), time_constant: float = 0.033, **options: Any
) -> Flight:
    """Return a quadrotor with powertrain and rate controller.

    Args:
        platform: the racer, or any other quadrotor.
        effects: further physics, for example of the catalogue.
        time_constant: of the motors, s, for which the controller is tuned.
        options: `period`, `substeps` and `integrator` of the flight.
    """
    drive = FittedEffect(Powertrain(), powertrain_values(platform, time_constant=time_constant), known=True)
    controller = Betaflight.tuned(platform, time_constant)
    return Flight(Simulator(platform, (drive, *effects)), controller, **options)
