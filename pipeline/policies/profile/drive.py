"""A straight drive on wheels whose motors obey V = kS·sign(v) + kV·v + kA·dv/dt, sampled without error."""

import math
from dataclasses import dataclass

import torch
from torch import Tensor


@dataclass(frozen=True)
class Drive:
    """The identified motors of all wheels, in metres along the ground.

    The law is WPILib's ("System Identification"), the sampling exact for a voltage that is held over a period: friction
    turns round, or holds, at the very instant at which a wheel stops.

    Attributes:
        static: kS by wheel, (wheels,) V.
        speed: kV, (wheels,) V/(m/s).
        acceleration: kA, (wheels,) V/(m/s²).
        voltage_limit: greatest voltage, V.
        acceleration_limit: of the grip of the tyres, m/s², which no voltage is to exceed.
    """

    static: Tensor
    speed: Tensor
    acceleration: Tensor
    voltage_limit: float = 12.0
    acceleration_limit: float = math.inf

    @property
    def time_constant(self) -> Tensor:
        """Of the speed under a held voltage, (wheels,) s."""
        return self.acceleration / self.speed

    def feedforward(self, velocity: Tensor, desired: Tensor, period: float) -> Tensor:
        """Return the voltage, unbounded, (..., wheels), that brings each wheel to a velocity within a period.

        Args:
            velocity: of each wheel now, (..., wheels) m/s.
            desired: at the end of the period, (..., wheels) m/s.
            period: s.
        """
        decay = torch.exp(-period / self.time_constant)
        direction = torch.where(desired == 0.0, velocity, desired).sign()
        return self.static * direction + self.speed * (desired - decay * velocity) / (1.0 - decay)

    def within_limits(self, velocity: Tensor, voltage: Tensor) -> Tensor:
        """Return the nearest voltage that the battery can give and the tyres can bear, (..., wheels) V.

        Args:
            velocity: of each wheel, (..., wheels) m/s.
            voltage: wanted, (..., wheels) V.
        """
        direction = torch.where(velocity == 0.0, voltage, velocity).sign()
        holding = self.static * direction + self.speed * velocity
        span = self.acceleration * self.acceleration_limit
        borne = voltage.maximum(holding - span).minimum(holding + span)
        return borne.clamp(-self.voltage_limit, self.voltage_limit)

    def advance(self, velocity: Tensor, voltage: Tensor, period: float) -> tuple[Tensor, Tensor]:
        """Return velocity, m/s, and distance made, m, of each wheel (..., wheels) after a period at a voltage.

        Args:
            velocity: of each wheel, (..., wheels) m/s.
            voltage: within the limit, (..., wheels) V.
            period: s.
        """
        whole = torch.full_like(velocity, period)
        before = self._glide(velocity, voltage, velocity.sign(), self._stop(velocity, voltage).minimum(whole))
        left = (whole - self._stop(velocity, voltage)).clamp(min=0.0)
        pushed = torch.where(voltage.abs() > self.static, voltage.sign(), torch.zeros_like(voltage))
        still = torch.zeros_like(velocity)
        after = self._glide(still, torch.where(pushed == 0.0, still, voltage), pushed, left)
        stopped = left > 0.0
        return torch.where(stopped, after[0], before[0]), before[1] + torch.where(stopped, after[1], still)

    def _steady_velocity(self, voltage: Tensor, direction: Tensor) -> Tensor:
        return (voltage - self.static * direction) / self.speed

    def _stop(self, velocity: Tensor, voltage: Tensor) -> Tensor:
        """Return when each wheel comes to a stop, s; infinite where it never does."""
        settled = self._steady_velocity(voltage, velocity.sign())
        stops = settled * velocity.sign() < 0.0
        ratio = torch.where(stops, -velocity / settled, torch.zeros_like(velocity))
        time = self.time_constant * torch.log1p(ratio)
        time = torch.where(stops, time, torch.full_like(velocity, torch.inf))
        return torch.where(velocity == 0.0, torch.zeros_like(velocity), time)

    def _glide(
        self, velocity: Tensor, voltage: Tensor, direction: Tensor, duration: Tensor
    ) -> tuple[Tensor, Tensor]:
        """Return velocity and distance after a duration in which friction keeps its direction."""
        settled = self._steady_velocity(voltage, direction)
        gone = -torch.expm1(-duration / self.time_constant)
        away = velocity - settled
        return velocity - away * gone, settled * duration + away * self.time_constant * gone
