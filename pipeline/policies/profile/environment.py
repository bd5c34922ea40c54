"""Driving a straight way from rest to rest: the policy says which speed it desires, the feedforward does the rest."""

import torch
from torch import Tensor

from pipeline.policies.environment import Environment, Machines, Observation
from pipeline.policies.profile.drive import Drive
from pipeline.policies.profile.rewards import final_reward, step_reward
from pipeline.policies.profile.settings import Profile

_NEAR, _SLOW = 0.1, 0.2  # m and m/s, below which what is left of distance and speed is also seen enlarged

_POSITION, _VELOCITY, _VOLTAGE = "position", "velocity", "voltage"


class MotionProfile(Environment):
    """Identified drives, each on a way of its own.

    The state is the position, m, the speeds of the four wheels, m/s along the ground, and the voltages that act. The
    action is the desired speed over its limit. The observation has the distance that is left, plain and enlarged near
    the target, the mean speed enlarged near standstill, and the speeds.

    Attributes:
        task: the way and what counts as arriving.
        drive: identified.
        tolerances: of position, m, and speed, m/s, that count now.
    """

    observation_size = 7
    privileged_size = 0
    action_size = 1

    def __init__(self, task: Profile, drive: Drive, batch: int, device: torch.device | str = "cpu") -> None:
        super().__init__(batch, device)
        self.task, self.drive = task, drive
        self.period = task.period
        self.episode_steps = round(task.episode / task.period)
        self.tolerances = tuple(task.narrow)
        self._arrived = self._failed = 0.0

    def schedule(self, share: float) -> None:
        """Narrow the tolerances, by equal factors, until the curriculum is done."""
        done = min(share / self.task.curriculum, 1.0)
        pairs = zip(self.task.wide, self.task.narrow, strict=True)
        self.tolerances = tuple(wide * (narrow / wide) ** done for wide, narrow in pairs)

    def reset(self, machines: Tensor) -> None:
        """Start at rest, or, for a share of the attempts, anywhere on the way at any speed."""
        if _POSITION not in self.state:
            self._make_room()
        chance, place, speed = torch.rand(
            (3, len(machines)), generator=self.generator, device=self.device
        ).unbind()
        moving = chance < self.task.on_the_way
        still = torch.zeros_like(place)
        start = torch.where(moving, speed * self.task.speed_limit, still)
        self.state[_POSITION][machines] = torch.where(moving, place * self.task.distance, still)
        self.state[_VELOCITY][machines] = start[:, None].expand(-1, len(self.drive.speed))
        self.state[_VOLTAGE][machines] = 0.0

    def _make_room(self) -> None:
        wheels = self.drive.speed.expand(self.batch, -1)
        self.state[_POSITION] = torch.zeros_like(wheels[:, 0])
        self.state[_VELOCITY], self.state[_VOLTAGE] = torch.zeros_like(wheels), torch.zeros_like(wheels)

    def advance(self, action: Tensor) -> tuple[Tensor, Tensor]:
        """Drive for a period; an attempt ends where it arrives or leaves the way."""
        task, before = self.task, self.state[_VOLTAGE]
        position, velocity = self.state[_POSITION], self.state[_VELOCITY]
        desired = (task.speed_limit * action).expand_as(velocity)
        wanted = self.drive.feedforward(velocity, desired, self.period)
        voltage = self.drive.within_limits(velocity, wanted)
        velocity, made = self.drive.advance(velocity, voltage, self.period)
        reached = position + made.mean(-1)
        self.state |= {_POSITION: reached, _VELOCITY: velocity, _VOLTAGE: voltage}
        left, speed = (task.distance - reached).abs(), velocity.mean(-1).abs()
        arrived = (left <= self.tolerances[0]) & (speed < self.tolerances[1])
        failed = (left > task.distance + task.overrun) | (reached > task.distance + task.overrun)
        progress = (task.distance - position).abs() - left
        reward = step_reward(task, left, progress, velocity, wanted, voltage, before)
        self._arrived += float(arrived.sum())
        self._failed += float(failed.sum())
        return reward + final_reward(task, arrived, failed, speed), arrived | failed

    def observe(self, machines: Machines = slice(None)) -> Observation:
        """Return the distance that is left and the speeds of the wheels."""
        left = self.task.distance - self.state[_POSITION][machines]
        velocity = self.state[_VELOCITY][machines]
        enlarged = torch.tanh(left / _NEAR), torch.tanh(velocity.mean(-1) / _SLOW)
        seen = torch.stack([left / self.task.distance, *enlarged], -1)
        return Observation(torch.cat([seen, velocity / self.task.speed_limit], -1), velocity[:, :0])

    def measures(self) -> dict[str, float]:
        """Return how many attempts have arrived and failed, and what arriving means now."""
        told = {"arrived": self._arrived, "failed": self._failed, "tolerance": self.tolerances[0]}
        self._arrived = self._failed = 0.0
        return told
