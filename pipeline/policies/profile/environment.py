"""Environment of a straight drive from rest to rest: the policy sets a speed for the feedforward."""

import torch
from torch import Tensor

from simgap.policies.environment import Environment, Machines, Observation
from simgap.policies.profile.drive import Drive
from simgap.policies.profile.driven import VELOCITY, Driven, LinearDrive
from simgap.policies.profile.rewards import final_reward, step_reward
from simgap.policies.profile.settings import Profile

_SLOW = 0.2  # m/s, below which the speed is also seen enlarged

_POSITION, _VOLTAGE = "position", "voltage"
_FROM_REST, _DIFFICULTY, _ENDED, _ARRIVED = "from_rest", "difficulty", "ended", "arrived"


class MotionProfile(Environment):
    """Drives, each on a way of its own.

    The state is the position, m, the speeds of the four wheels, m/s along the ground, and the acting voltages. The
    action is the desired speed over its limit. The observation holds the remaining distance and its square root, which
    is proportional to the speed from which a constant deceleration stops at the target. It also holds the mean speed,
    enlarged near standstill, and the wheel speeds.

    Attributes:
        task: the way and what counts as arriving.
        drive: identified, whose feedforward turns the desired speed into voltages.
        driven: what these voltages move.
    """

    observation_size = 7
    privileged_size = 0
    action_size = 1

    def __init__(
        self,
        task: Profile,
        drive: Drive,
        batch: int,
        device: torch.device | str = "cpu",
        driven: Driven | None = None,
    ) -> None:
        super().__init__(batch, device)
        self.task, self.drive = task, drive
        self.driven = driven or LinearDrive(drive)
        self._changing: tuple[str, ...] = ()
        self.period = task.period
        self.episode_steps = round(task.episode / task.period)
        self._failed = 0.0

    @property
    def tolerances(self) -> tuple[float, float]:
        """Of position, m, and speed, m/s: what counts as arriving now."""
        done = float(self.state[_DIFFICULTY]) if _DIFFICULTY in self.state else 1.0
        position, speed = (
            wide * (narrow / wide) ** done
            for wide, narrow in zip(self.task.wide, self.task.narrow, strict=True)
        )
        return position, speed

    def schedule(self, share: float) -> None:
        """Narrow the tolerances by a step where enough of the whole ways since the last time have arrived."""
        ended, arrived = float(self.state[_ENDED]), float(self.state[_ARRIVED])
        harder = 0.0
        if _DIFFICULTY in self.state:
            enough = ended > 0.0 and arrived >= self.task.success * ended
            harder = min(float(self.state[_DIFFICULTY]) + enough / self.task.curriculum, 1.0)
        self.state |= {
            _DIFFICULTY: torch.tensor(harder),
            _ENDED: torch.tensor(0.0),
            _ARRIVED: torch.tensor(0.0),
        }

    def reset(self, machines: Tensor) -> None:
        """Start at rest, or, for a share of the attempts, anywhere on the way at any speed."""
        if _POSITION not in self.state:
            self._make_room()
        else:
            self.state[_ENDED] = self.state[_ENDED] + self.state[_FROM_REST][machines].sum()
        chance, place, speed = torch.rand(
            (3, len(machines)), generator=self.generator, device=self.device
        ).unbind()
        moving = chance < self.task.on_the_way
        still = torch.zeros_like(place)
        self.state[_FROM_REST][machines] = ~moving
        start = torch.where(moving, speed * self.task.speed_limit, still)
        self.state[_POSITION][machines] = torch.where(moving, place * self.task.distance, still)
        for name, fresh in self.driven.begin(start[:, None].repeat(1, len(self.drive.speed))).items():
            self.state[name][machines] = fresh
        self.state[_VOLTAGE][machines] = 0.0

    def _make_room(self) -> None:
        wheels = self.drive.speed.expand(self.batch, -1)
        self.state[_POSITION] = torch.zeros_like(wheels[:, 0])
        self.state[_FROM_REST] = torch.zeros_like(wheels[:, 0], dtype=torch.bool)
        self.state[_ENDED] = self.state[_ARRIVED] = torch.tensor(0.0)
        self.state[_VOLTAGE] = torch.zeros_like(wheels)
        rolling = self.driven.begin(torch.zeros_like(wheels))
        self._changing = tuple(rolling)
        self.state |= rolling

    def advance(self, action: Tensor) -> tuple[Tensor, Tensor]:
        """Drive for a period; an attempt ends where it arrives or leaves the way."""
        task, before = self.task, self.state[_VOLTAGE]
        position, velocity = self.state[_POSITION], self.state[VELOCITY]
        desired = (task.speed_limit * action).expand_as(velocity)
        wanted = self.drive.feedforward(velocity, desired, self.period)
        voltage = self.drive.within_limits(velocity, wanted)
        rolling = {name: self.state[name] for name in self._changing}
        rolling, made = self.driven.advance(rolling, voltage, self.period)
        velocity, reached = rolling[VELOCITY], position + made.mean(-1)
        self.state |= {_POSITION: reached, _VOLTAGE: voltage, **rolling}
        left, speed = (task.distance - reached).abs(), velocity.mean(-1).abs()
        near, slow = self.tolerances
        arrived = (left <= near) & (speed < slow)
        failed = (left > task.distance + task.overrun) | (reached > task.distance + task.overrun)
        progress = (task.distance - position).abs() - left
        reward = step_reward(task, progress, velocity, wanted, voltage, before)
        self.state[_ARRIVED] = self.state[_ARRIVED] + (arrived & self.state[_FROM_REST]).sum()
        self._failed += float(failed.sum())
        return reward + final_reward(task, arrived, failed, speed), arrived | failed

    def observe(self, machines: Machines = slice(None)) -> Observation:
        """Return the distance that is left and the speeds of the wheels."""
        left = 1.0 - self.state[_POSITION][machines] / self.task.distance
        velocity = self.state[VELOCITY][machines]
        slow = torch.tanh(velocity.mean(-1) / _SLOW)
        seen = torch.stack([left, left.sign() * left.abs().sqrt(), slow], -1)
        return Observation(torch.cat([seen, velocity / self.task.speed_limit], -1), velocity[:, :0])

    def measures(self) -> dict[str, float]:
        """Return how many whole ways have ended and arrived, how many attempts failed, and what arriving means now."""
        told = {name: float(self.state[name]) for name in (_ENDED, _ARRIVED)}
        told |= {"failed": self._failed, "tolerance": self.tolerances[0]}
        self._failed = 0.0
        return told
