"""A point mass that has to come to rest at a target: small enough to be solved in seconds."""

import torch
from torch import Tensor

from simgap.policies.environment import Environment, Machines, Observation


class PointMass(Environment):
    """A unit mass on a line, pushed with at most 2 N; reward is −(x² + 0.1·v²) per second."""

    observation_size = 2
    privileged_size = 1
    action_size = 1
    period = 0.1
    episode_steps = 40

    def reset(self, machines: Tensor) -> None:
        start = torch.rand(len(machines), 2, generator=self.generator, device=self.device) * 2.0 - 1.0
        if "motion" not in self.state:
            self.state["motion"] = torch.zeros(self.batch, 2, device=self.device)
        self.state["motion"][machines] = start

    def advance(self, action: Tensor) -> tuple[Tensor, Tensor]:
        position, velocity = self.state["motion"].unbind(-1)
        velocity = velocity + self.period * 2.0 * action[:, 0]
        position = position + self.period * velocity
        self.state["motion"] = torch.stack([position, velocity], -1)
        reward = -self.period * (position.square() + 0.1 * velocity.square())
        return reward, position.abs() > 4.0

    def observe(self, machines: Machines = slice(None)) -> Observation:
        motion = self.state["motion"][machines]
        return Observation(motion.clone(), motion[:, :1] ** 2)
