"""Model-predictive control that tracks a time-optimal lap.

Each step predicts the motion over a horizon by the rigid body linearised about the lap. It finds the commands within
the machine's limits that track the lap best: a quadratic programme with bounds, condensed to the commands alone. Only
the tracking error changes from lap to lap, so the matrices are computed once.

Sources: Foehn, Romero & Scaramuzza 2021, "Time-optimal planning for quadrotor waypoint flight", Science Robotics 6
(the lap, tracked by model-predictive control); Boyd et al. 2011, "Distributed optimization and statistical learning
via the alternating direction method of multipliers", §5.2 (quadratic programmes with bounds).
"""

from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from simgap.gates.track import Track
from simgap.physics import rotations
from simgap.policies.environment import Observation
from simgap.policies.racing.observation import seen_state
from simgap.policies.racing.settings import Flying, RacingSettings
from simgap.policies.racing.starts import first_starts
from simgap.policies.racing.time_optimal import Limits, OptimalLap, optimal_lap

_ERROR, _INPUT = 9, 4
_PLACE, _SPEED, _TURN = slice(0, 3), slice(3, 6), slice(6, 9)


@dataclass(frozen=True)
class Tuning:
    """What the tracking minimises, and how far and how exactly.

    Attributes:
        horizon: steps that are looked ahead.
        position: weight of a squared error of 1 m.
        velocity: of 1 m/s.
        attitude: of 1 rad.
        thrust: of a command that differs by 1 m/s² from the lap's.
        rate: of one that differs by 1 rad/s.
        iterations: of the solver.
        ahead: steps along the lap in which a machine's place is looked for.
    """

    horizon: int = 40
    position: float = 30.0
    velocity: float = 1.0
    attitude: float = 5.0
    thrust: float = 0.02
    rate: float = 0.2
    iterations: int = 30
    ahead: int = 8


@dataclass(frozen=True)
class _Way:
    """The way on the control steps: position, velocity, rotation and command, (steps, ...); then the lap, for ever.

    Attributes:
        lap: how many of the steps, the last ones, are the lap.
    """

    position: Tensor
    velocity: Tensor
    rotation: Tensor
    command: Tensor
    lap: int

    def __len__(self) -> int:
        return len(self.position)

    def after(self, step: Tensor) -> Tensor:
        """Return the step that a number of steps from the start is."""
        over = (step - len(self)).clamp_min(0)
        return torch.where(step < len(self), step, len(self) - self.lap + over % self.lap)


def time_optimal_pilot(
    track: Track, settings: RacingSettings, gravity: float, share: float = 0.85, tuning: Tuning | None = None
) -> "Tracker":
    """Return the pilot that tracks the time-optimal laps of a track, the first from where races begin.

    Args:
        track: its gates.
        settings: of the race.
        gravity: m/s².
        share: of the greatest thrust that the plan takes; what is left is for tracking it.
        tuning: of the tracking.

    Raises:
        InputError: when no such lap is found.
    """
    limits = Limits.of(settings.flying, share)
    lap = optimal_lap(track, limits, gravity)
    line = first_starts(track, settings.starts)[-1, 0].double().cpu().numpy()
    start = optimal_lap(track, limits, gravity, ends=(line, lap.states[0]))
    return Tracker(start, lap, settings.flying, gravity, tuning)


class Tracker:
    """A pilot that follows a lap; see `simgap.policies.racing.laps.Pilot`. It is at the start when it is made.

    Attributes:
        way: what is followed.
    """

    def __init__(
        self,
        start: OptimalLap,
        lap: OptimalLap,
        flying: Flying,
        gravity: float,
        tuning: Tuning | None = None,
    ) -> None:
        """Prepare the programmes of all steps of the way.

        Args:
            start: the first lap.
            lap: to follow after it, round and round.
            flying: with the greatest thrust and rates that may be commanded, and the time between two commands.
            gravity: m/s².
            tuning: of the tracking.
        """
        self._tuning = tuning or Tuning()
        self.way = _resampled(start, lap, flying.period)
        self._most = torch.tensor([flying.thrust, flying.rate, flying.rate, flying.yaw_rate])
        self._least = torch.tensor([0.0, -flying.rate, -flying.rate, -flying.yaw_rate])
        self._gravity = gravity
        self._inverse, self._slope, self._weight = _programmes(self.way, self._tuning, flying.period)
        self._place: Tensor | None = None

    def __call__(self, seen: Observation) -> Tensor:
        """Return actions (batch, 4) within ±1 for what is seen of the machines."""
        position, velocity, rotation = seen_state(seen)
        place, way = self._nearest(position), self.way
        self._place = place
        turned = way.rotation[place].transpose(1, 2) @ rotation
        error = torch.cat(
            [
                position - way.position[place],
                velocity - way.velocity[place],
                rotations.to_rotation_vector(rotations.from_matrix(turned)),
            ],
            dim=-1,
        )
        command = way.command[place] + self._solved(place, error)
        return self._action(command)

    def _nearest(self, position: Tensor) -> Tensor:
        """Return the step of the way that each machine is at, (batch,): where it was, or a little further."""
        before = torch.zeros(len(position), dtype=torch.int64) if self._place is None else self._place
        near = self.way.after(before[:, None] + torch.arange(self._tuning.ahead))
        away = (position[:, None] - self.way.position[near]).square().sum(-1)
        return near.gather(1, away.argmin(1, keepdim=True))[:, 0]

    def _solved(self, place: Tensor, error: Tensor) -> Tensor:
        """Return what the commands that keep closest to the way begin with, (batch, 4), less the way's own."""
        planned = self.way.command[self.way.after(place[:, None] + torch.arange(self._tuning.horizon))]
        least, most = (self._least - planned).flatten(1), (self._most - planned).flatten(1)
        slope = (self._slope[place] @ error[..., None])[..., 0]
        best = bounded_least(
            self._inverse[place], self._weight, slope, (least, most), self._tuning.iterations
        )
        return best[:, :_INPUT]

    def _action(self, command: Tensor) -> Tensor:
        """Return what `simgap.policies.racing.racing.commanded` makes a command of."""
        thrust = (command[:, :1] - self._gravity) / (self._most[0] - self._gravity)
        return torch.cat([thrust, command[:, 1:] / self._most[1:]], dim=-1).clamp(-1.0, 1.0)


def bounded_least(
    inverse: Tensor, weight: float, slope: Tensor, bounds: tuple[Tensor, Tensor], iterations: int
) -> Tensor:
    """Return what minimises ½·xᵀHx + slopeᵀx within bounds, (batch, n), by alternating directions.

    Args:
        inverse: of H + weight·1, (batch, n, n).
        weight: of the regularisation.
        slope: (batch, n).
        bounds: least and greatest x, (batch, n) each.
        iterations: after which it is left.
    """
    bounded, price = torch.zeros_like(slope), torch.zeros_like(slope)
    for _ in range(iterations):
        free = (inverse @ (weight * (bounded - price) - slope)[..., None])[..., 0]
        bounded = torch.minimum(torch.maximum(free + price, bounds[0]), bounds[1])
        price = price + free - bounded
    return bounded


def _resampled(start: OptimalLap, lap: OptimalLap, period: float) -> _Way:
    """Return both laps on whole control steps."""
    parts = [_on_steps(part, period) for part in (start, lap)]
    position, velocity, rotation, command = (torch.cat(pair) for pair in zip(*parts, strict=True))
    return _Way(position, velocity, rotation, command, lap=len(parts[1][0]))


def _on_steps(lap: OptimalLap, period: float) -> tuple[Tensor, Tensor, Tensor, Tensor]:
    """Return position, velocity, rotation and command of a lap on whole control steps."""
    steps = round(lap.duration / period)
    times = np.arange(steps) * lap.duration / steps
    states = np.stack([np.interp(times, lap.times, column) for column in _continued(lap.states).T], axis=-1)
    thrust = np.interp(times, 0.5 * (lap.times[1:] + lap.times[:-1]), lap.inputs[:, 0])
    state = torch.tensor(states, dtype=torch.float32)
    rotation = rotations.to_matrix(rotations.normalize(state[:, 3:7]))
    command = torch.cat([torch.tensor(thrust, dtype=torch.float32)[:, None], state[:, 10:]], dim=-1)
    return state[:, :3], state[:, 7:10], rotation, command


def _continued(states: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the states with quaternions that do not jump to their negatives."""
    turned = np.sign((states[1:, 3:7] * states[:-1, 3:7]).sum(1))
    sign = np.concatenate([[1.0], np.cumprod(turned)])
    return np.concatenate([states[:, :3], sign[:, None] * states[:, 3:7], states[:, 7:]], axis=1)


def _programmes(way: _Way, tuning: Tuning, period: float) -> tuple[Tensor, Tensor, float]:
    """Return for each step the inverse of the regularised Hessian and the slope per error, and the regularisation.

    Shapes (steps, horizon·4, horizon·4) and (steps, horizon·4, 9).
    """
    forward, input_ = _linearised(way, period)
    steps, horizon = len(forward), tuning.horizon
    index = way.after(torch.arange(steps)[:, None] + torch.arange(horizon))
    cost = torch.ones(_ERROR)
    cost[_PLACE], cost[_SPEED], cost[_TURN] = tuning.position, tuning.velocity, tuning.attitude
    effort = torch.tensor([tuning.thrust, tuning.rate, tuning.rate, tuning.rate]).repeat(horizon)
    error = torch.eye(_ERROR).expand(steps, -1, -1)
    reached = torch.zeros(steps, _ERROR, horizon * _INPUT)
    hessian = torch.diag(effort).expand(steps, -1, -1).clone()
    slope = torch.zeros(steps, horizon * _INPUT, _ERROR)
    for ahead in range(horizon):
        move, act = forward[index[:, ahead]], input_[index[:, ahead]]
        error, reached = move @ error, move @ reached
        reached[..., _INPUT * ahead : _INPUT * (ahead + 1)] = act
        weighted = reached.transpose(1, 2) * cost
        hessian += weighted @ reached
        slope += weighted @ error
    weight = float(hessian.diagonal(dim1=1, dim2=2).mean())
    return torch.linalg.inv(hessian + weight * torch.eye(horizon * _INPUT)), slope, weight


def _linearised(way: _Way, period: float) -> tuple[Tensor, Tensor]:
    """Return how an error of place, velocity and attitude (body frame) goes on, and what commands add to it.

    Shapes (steps, 9, 9) and (steps, 9, 4); the rates are taken to be flown as commanded.
    """
    steps, up = len(way), torch.tensor([0.0, 0.0, 1.0])
    thrust, rate = way.command[:, 0], way.command[:, 1:]
    rate_of = torch.zeros(steps, _ERROR, _ERROR)
    rate_of[:, _PLACE, _SPEED] = torch.eye(3)
    tilting = _cross_matrix(up).T  # up changes by turn × up
    rate_of[:, _SPEED, _TURN] = thrust[:, None, None] * way.rotation @ tilting
    rate_of[:, _TURN, _TURN] = -_cross_matrix(rate)
    added = torch.zeros(steps, _ERROR, _INPUT)
    added[:, _SPEED, :1] = way.rotation @ up[:, None]
    added[:, _TURN, 1:] = torch.eye(3)
    forward = torch.eye(_ERROR) + period * rate_of + 0.5 * period**2 * rate_of @ rate_of
    return forward, period * added + 0.5 * period**2 * rate_of @ added


def _cross_matrix(vector: Tensor) -> Tensor:
    """Return the matrix (..., 3, 3) whose product with another vector is the cross product with it."""
    spread = vector[..., None, :].expand(*vector.shape, 3)
    return torch.linalg.cross(spread, torch.eye(3).expand(spread.shape)).transpose(-1, -2)
