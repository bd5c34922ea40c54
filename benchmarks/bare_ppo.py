"""Proximal policy optimisation with nothing but PyTorch: what the project's own training is measured against."""

import math

import torch
from torch import Tensor, nn

from simgap.policies.environment import Environment, Observation
from simgap.policies.ppo import networks
from simgap.policies.settings import Learning


class BarePPO:
    """The same networks, draws and updates as `simgap.policies`, written as one loop.

    Attributes:
        gaussian: from which actions are drawn.
    """

    def __init__(self, environment: Environment, settings: Learning, seed: int) -> None:
        """Start the machines and draw the networks."""
        self.environment, self.settings = environment, settings
        torch.manual_seed(seed)
        self.gaussian, self.critic = networks(environment, settings)
        self.random = torch.Generator(environment.device).manual_seed(seed)
        self.parameters = [*self.gaussian.parameters(), *self.critic.parameters()]
        self.optimizer = torch.optim.Adam(self.parameters, lr=settings.learning_rate, fused=True)
        self.seen = environment.start(seed)

    def update(self) -> None:
        """Fly a segment and learn from it."""
        with torch.no_grad():
            samples = self._flown()
        count = len(samples[0])
        for _ in range(self.settings.epochs):
            order = torch.randperm(count, generator=self.random, device=self.environment.device)
            for part in order.split(self.settings.minibatch):
                self._improve(*(tensor[part] for tensor in samples))

    def _flown(self) -> list[Tensor]:
        rows: list[list[Tensor]] = []
        for _ in range(self.settings.horizon):
            mean, deviation = self.gaussian(self.seen.policy)
            action = mean + deviation * torch.randn(mean.shape, generator=self.random, device=mean.device)
            density = self._density(mean, deviation, action)
            stepped = self.environment.step(action)
            reached = self._value(stepped.reached) * stepped.truncated
            ended = stepped.terminated | stepped.truncated
            rows.append(
                [self.seen.policy, self.seen.privileged, action, density, stepped.reward, ended, reached]
            )
            self.seen = stepped.observation
        seen, privileged, action, density, reward, ended, reached = (
            torch.stack(c) for c in zip(*rows, strict=True)
        )
        value = self.critic(seen, privileged)[..., 0]
        following = torch.where(ended, reached, torch.cat([value[1:], self._value(self.seen)[None]]))
        advantage = self._advantage(reward, value, following, ended)
        target = advantage + value
        scaled = (advantage - advantage.mean()) / (advantage.std() + 1e-8)
        return [tensor.flatten(0, 1) for tensor in (seen, privileged, action, density, scaled, target)]

    def _value(self, seen: Observation) -> Tensor:
        return self.critic(seen.policy, seen.privileged)[..., 0]

    def _advantage(self, reward: Tensor, value: Tensor, following: Tensor, ended: Tensor) -> Tensor:
        settings = self.settings
        surprise = reward * settings.reward_scale + settings.discount * following - value
        advantage, later = torch.empty_like(reward), torch.zeros_like(reward[0])
        for step in reversed(range(len(reward))):
            later = surprise[step] + settings.discount * settings.trace * later * ~ended[step]
            advantage[step] = later
        return advantage

    def _improve(
        self,
        seen: Tensor,
        privileged: Tensor,
        action: Tensor,
        density: Tensor,
        advantage: Tensor,
        target: Tensor,
    ) -> None:
        settings = self.settings
        mean, deviation = self.gaussian(seen)
        ratio = (self._density(mean, deviation, action) - density).exp()
        clipped = ratio.clamp(1.0 - settings.clip, 1.0 + settings.clip)
        gain = torch.minimum(ratio * advantage, clipped * advantage).mean()
        entropy = (deviation.log() + 0.5 * math.log(2.0 * math.pi * math.e)).sum(-1).mean()
        error = (self.critic(seen, privileged)[..., 0] - target).square().mean()
        loss = settings.critic * error - gain - settings.entropy * entropy
        self.optimizer.zero_grad()
        loss.backward()
        nn.utils.clip_grad_norm_(self.parameters, settings.gradient_norm)
        self.optimizer.step()

    @staticmethod
    def _density(mean: Tensor, deviation: Tensor, action: Tensor) -> Tensor:
        scaled = (action - mean) / deviation
        return (-0.5 * scaled.square() - deviation.log() - 0.5 * math.log(2.0 * math.pi)).sum(-1)
