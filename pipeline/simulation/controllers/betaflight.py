"""Betaflight's rate controller, with the details that matter to a policy trained in simulation.

Kaufmann et al. 2023, "Champion-level drone racing using deep reinforcement learning", Nature 620, Methods; defaults
from the firmware's documentation (betaflight.com/docs, CLI reference).
"""

import math
from dataclasses import dataclass
from functools import cached_property

import torch
from jaxtyping import Float
from torch import Tensor

from simgap.errors import InputError
from simgap.physics.motors import first_order_lag
from simgap.physics.shapes import PerModule, Signal, Vector
from simgap.platforms import Quadrotor
from simgap.simulation.controllers.mixer import distribution, mix

Memory = dict[str, Signal] | None


@dataclass(frozen=True)
class Betaflight:
    """Collective thrust and body rates in, four throttles out.

    The derivative acts on the measurement (its reference is zero), the integral is reset while the throttle is cut, and
    under saturation all motors are scaled down so that the rates keep priority.

    Attributes:
        platform: whose geometry, inertia and thrust law the mixer knows.
        proportional: per axis, 1/s: angular acceleration per error of rate.
        integral: per axis, 1/s².
        derivative: per axis, 1: angular acceleration per measured angular acceleration.
        derivative_cutoff: of the first-order filter of the derivative, Hz.
        integral_limit: greatest angular acceleration of the integral, rad/s².
        idle: throttle below which no motor goes while all share the load alike (`dshot_idle_value` 550 of 10,000).
        cut: throttle below which the throttle is cut (`min_check` 1050 of 1000 to 2000).
    """

    platform: Quadrotor
    proportional: tuple[float, float, float]
    integral: tuple[float, float, float]
    derivative: tuple[float, float, float]
    derivative_cutoff: float = 100.0
    integral_limit: float = 100.0
    idle: float = 0.055
    cut: float = 0.05

    @classmethod
    def tuned(cls, platform: Quadrotor, time_constant: float, damping: float = 0.7) -> "Betaflight":
        """Return gains for motors of a time constant.

        With a derivative gain of one, the rate obeys time_constant·ω̈ + 2·ω̇ + P·ω = P·reference, whose damping fixes P.
        The integral takes over below a tenth of that loop's natural frequency.

        Args:
            platform: to be flown.
            time_constant: of the motors, s.
            damping: of the closed loop.

        Raises:
            InputError: when the time constant or the damping is not positive.
        """
        if not (time_constant > 0 and damping > 0):
            raise InputError("must be positive", "time_constant and damping", "give the motors' lag in s")
        gain = 1.0 / (damping**2 * time_constant)
        slow = 0.1 * math.sqrt(gain / time_constant)
        return cls(platform, (gain,) * 3, (gain * slow,) * 3, (1.0,) * 3)

    @cached_property
    def _spread(self) -> Tensor:
        return distribution(self.platform)

    def command(
        self, body_rate: Vector, reference: Float[Tensor, "*#batch 4"], memory: Memory, time_step: float
    ) -> tuple[PerModule, dict[str, Signal]]:
        """Return the throttles and what the controller remembers.

        Args:
            body_rate: measured, (..., 3) rad/s.
            reference: collective thrust over mass and body rates, (..., 4) m/s² and rad/s.
            memory: of the step before; None before the first.
            time_step: since that step, s.

        Returns:
            Throttles (..., 4) above 0 to 1, and the memory.
        """
        thrust = self.platform.mass * reference[..., 0]
        acceleration, after = self._regulate(body_rate, reference[..., 1:], memory, thrust, time_step)
        torque = acceleration * self._like(self.platform.inertia, body_rate)
        spread = self._spread.to(body_rate)
        most = self.platform.thrust_coefficient * self.platform.motor_speed_max**2
        least = 4.0 * self.idle**2 * most * spread[:, 0]
        share = mix(thrust, torque, spread, least, most) / most
        return torch.sqrt(share), after

    def _regulate(
        self, body_rate: Tensor, wanted: Tensor, memory: Memory, thrust: Tensor, time_step: float
    ) -> tuple[Tensor, dict[str, Tensor]]:
        """Return the wanted angular acceleration (..., 3), rad/s²."""
        if memory is None:
            memory = {
                "rate": body_rate,
                "integral": torch.zeros_like(body_rate),
                "slope": torch.zeros_like(body_rate),
            }
        error = wanted - body_rate
        slope = first_order_lag(
            memory["slope"],
            (body_rate - memory["rate"]) / time_step,
            1.0 / (2.0 * math.pi * self.derivative_cutoff),
            time_step,
        )
        grown = memory["integral"] + self._like(self.integral, body_rate) * error * time_step
        limited = grown.clamp(-self.integral_limit, self.integral_limit)
        integral = torch.where(self._is_cut(thrust)[..., None], torch.zeros_like(limited), limited)
        acceleration = (
            self._like(self.proportional, body_rate) * error
            + integral
            - self._like(self.derivative, body_rate) * slope
        )
        return acceleration, {"rate": body_rate, "integral": integral, "slope": slope}

    def _is_cut(self, thrust: Tensor) -> Tensor:
        full = 4.0 * self.platform.thrust_coefficient * self.platform.motor_speed_max**2
        return thrust < self.cut**2 * full

    def _like(self, values: tuple[float, float, float], like: Tensor) -> Tensor:
        return torch.tensor(values, dtype=like.dtype, device=like.device)
