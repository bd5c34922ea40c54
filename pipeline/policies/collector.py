"""Collection of experience in an environment."""

from dataclasses import dataclass

import torch
from tensordict import TensorDict
from torch import Tensor

from simgap.policies.environment import Environment, Observation, Transition
from simgap.policies.networks import Critic, Gaussian


@dataclass(frozen=True)
class Segment:
    """Some control steps of all machines.

    Attributes:
        steps: (horizon, batch) of `observation`, `privileged`, `action` and `action_log_prob`, and (horizon, batch, 1)
            of `reward`, `terminated`, `done`, `value` and `next_value`.
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
        steps: TensorDict | None = None
        ended: list[Tensor] = []
        for step in range(horizon):
            action, density = gaussian.sample(self.observation.policy, generator)
            transition = self.environment.step(action)
            row = _row(self.observation, action, density, transition, critic)
            steps = _room(row, horizon) if steps is None else steps
            for name, tensor in row.items():
                steps.get(name)[step].copy_(tensor)
            ended.append(self._account(transition))
            self.observation = transition.observation
        assert steps is not None
        self._value(steps, critic)
        return Segment(steps, self._measures(steps, torch.cat(ended)))

    def _account(self, transition: Transition) -> Tensor:
        """Return the returns of the episodes that ended."""
        self.returns += transition.reward
        over = transition.terminated | transition.truncated
        ended = self.returns[over]
        self.returns[over] = 0.0
        return ended

    def _value(self, steps: TensorDict, critic: Critic) -> None:
        """Write the values of what was seen, and of what was seen next where the episode was not cut off there."""
        value = critic(steps["observation"], steps["privileged"])
        last = critic(self.observation.policy, self.observation.privileged)
        following = torch.cat([value[1:], last[None]])
        steps["value"] = value
        steps["next_value"] = torch.where(steps["done"], steps["next_value"], following)

    def _measures(self, steps: TensorDict, ended: Tensor) -> dict[str, float]:
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


def _row(
    seen: Observation, action: Tensor, density: Tensor, transition: Transition, critic: Critic
) -> dict[str, Tensor]:
    return {
        "observation": seen.policy,
        "privileged": seen.privileged,
        "action": action,
        "action_log_prob": density,
        "reward": transition.reward[:, None],
        "terminated": transition.terminated[:, None],
        "done": (transition.terminated | transition.truncated)[:, None],
        "next_value": _cut_off_value(transition, critic),
    }


def _cut_off_value(transition: Transition, critic: Critic) -> Tensor:
    """Return the value of what was reached where the episode was cut off there, and zero elsewhere, (batch, 1)."""
    value = torch.zeros_like(transition.reward)[:, None]
    cut = transition.truncated.nonzero()[:, 0]
    if len(cut):
        value[cut] = critic(transition.reached.policy[cut], transition.reached.privileged[cut])
    return value


def _room(row: dict[str, Tensor], horizon: int) -> TensorDict:
    batch = len(row["reward"])
    room = {name: tensor.new_empty((horizon, *tensor.shape)) for name, tensor in row.items()}
    return TensorDict(room, batch_size=[horizon, batch])  # type: ignore[arg-type]
