"""Collection of experience in an environment."""

from dataclasses import dataclass

import torch
from tensordict import TensorDict
from torch import Tensor

from simgap.policies.environment import Environment, Transition
from simgap.policies.networks import Critic, Gaussian


@dataclass(frozen=True)
class Segment:
    """Some control steps of all machines.

    Attributes:
        steps: (horizon, batch) of `observation`, `privileged`, `action` and `action_log_prob`, and (horizon, batch, 1)
            of `reward`, `terminated`, `done`, `returned` (the episode's rewards so far), `value` and `next_value`.
        measures: means over the segment and over the episodes that ended in it.
    """

    steps: TensorDict
    measures: dict[str, float]


class Collector:
    """Acts with a policy, and keeps the state of the machines between two segments.

    Attributes:
        environment: to act in, started.
        observation: what the machines see now.
        returns: of the episodes that are under way, (batch,).
    """

    def __init__(self, environment: Environment, seed: int) -> None:
        self.environment = environment
        self.observation = environment.start(seed)
        self.returns = torch.zeros(environment.batch, device=environment.device)

    @torch.no_grad()
    def collect(
        self, gaussian: Gaussian, critic: Critic, horizon: int, generator: torch.Generator
    ) -> Segment:
        """Let all machines act for some control steps.

        Args:
            gaussian: from which the actions are drawn.
            critic: which values where they lead.
            horizon: control steps.
            generator: of the draws.
        """
        steps = self._steps(gaussian, critic, horizon, generator)
        self._value(steps, critic)
        return Segment(steps, self._measures(steps))

    def _steps(
        self, gaussian: Gaussian, critic: Critic, horizon: int, generator: torch.Generator
    ) -> TensorDict:
        """Return control steps of all machines, not valued yet."""
        row = self._step(gaussian, critic, generator)
        steps = room(row, horizon)
        for step in range(horizon):
            row = row if step == 0 else self._step(gaussian, critic, generator)
            for name, tensor in row.items():
                steps.get(name)[step].copy_(tensor)
        return steps

    def _step(self, gaussian: Gaussian, critic: Critic, generator: torch.Generator) -> dict[str, Tensor]:
        """Let all machines act once, and return what is kept of it."""
        seen = self.observation
        action, density = gaussian.sample(seen.policy, generator)
        transition = self.environment.step(action)
        self.observation = transition.observation
        done = transition.terminated | transition.truncated
        self.returns += transition.reward
        row = {
            "observation": seen.policy,
            "privileged": seen.privileged,
            "action": action,
            "action_log_prob": density,
            "reward": transition.reward[:, None],
            "terminated": transition.terminated[:, None],
            "done": done[:, None],
            "returned": self.returns[:, None].clone(),
            "next_value": self._cut_off_value(transition, critic),
        }
        self.returns.masked_fill_(done, 0.0)
        return row

    def _cut_off_value(self, transition: Transition, critic: Critic) -> Tensor:
        """Return the value of what was reached where the episode was cut off there, and zero elsewhere, (batch, 1)."""
        reached, cut = transition.reached, transition.truncated[:, None]
        if self.environment.captured:
            return critic(reached.policy, reached.privileged) * cut
        value = torch.zeros_like(transition.reward)[:, None]
        machines = cut.nonzero()[:, 0]
        if len(machines):
            value[machines] = critic(reached.policy[machines], reached.privileged[machines])
        return value

    def _value(self, steps: TensorDict, critic: Critic) -> None:
        """Write the values of what was seen, and of what was seen next where the episode was not cut off there."""
        value = critic(steps["observation"], steps["privileged"])
        last = critic(self.observation.policy, self.observation.privileged)
        following = torch.cat([value[1:], last[None]])
        steps["value"] = value
        steps["next_value"] = torch.where(steps["done"], steps["next_value"], following)

    def _measures(self, steps: TensorDict) -> dict[str, float]:
        ended = steps["returned"][steps["done"]]
        measures = {"reward": float(steps["reward"].mean()), "episodes": float(len(ended))}
        if len(ended):
            measures["return"] = float(ended.mean())
            measures["terminated"] = float(steps["terminated"].sum()) / len(ended)
        return measures | self.environment.measures()

    def snapshot(self) -> dict[str, dict[str, Tensor]]:
        """Return all that the segments to come depend on."""
        return {"environment": self.environment.snapshot(), "collector": {"returns": self.returns.cpu()}}

    def resume(self, snapshot: dict[str, dict[str, Tensor]]) -> None:
        """Go on where a snapshot was taken."""
        self.observation = self.environment.resume(snapshot["environment"])
        self.returns = snapshot["collector"]["returns"].to(self.environment.device)


def room(row: dict[str, Tensor], horizon: int) -> TensorDict:
    """Return a place for control steps (horizon, batch), of which this is one."""
    batch = len(row["reward"])
    places = {name: tensor.new_empty((horizon, *tensor.shape)) for name, tensor in row.items()}
    return TensorDict(places, batch_size=[horizon, batch])  # type: ignore[arg-type]
