"""Vectorised environments: a batch of machines with automatic resets."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import torch
from torch import Tensor

Machines = Tensor | slice
"""Indices (machines,) of some machines of the batch, or all of them."""

_GENERATOR, _AGE = "generator", "age"


@dataclass(frozen=True)
class Observation:
    """Observations of some machines, float32, scaled to the order of one.

    Attributes:
        policy: what the policy sees, (machines, observation_size).
        privileged: what the critic sees besides, (machines, privileged_size); exact, and not to be had on a machine.
    """

    policy: Tensor
    privileged: Tensor

    def replaced(self, machines: Tensor, fresh: "Observation") -> "Observation":
        """Return the observation with that of some machines in place of theirs."""
        return Observation(
            self.policy.index_copy(0, machines, fresh.policy),
            self.privileged.index_copy(0, machines, fresh.privileged),
        )


@dataclass(frozen=True)
class Transition:
    """Result of one action, for every machine of the batch.

    Attributes:
        reached: what is seen where the action led.
        reward: (batch,).
        terminated: the episode ended there, and nothing is to be had after it, (batch,) bool.
        truncated: the episode was cut off there, though it could have gone on, (batch,) bool.
        observation: what the next action is to be chosen by: `reached`, or the start of the next episode.
    """

    reached: Observation
    reward: Tensor
    terminated: Tensor
    truncated: Tensor
    observation: Observation


class Environment(ABC):
    """A batch of machines. An environment implements `reset`, `advance` and `observe`; this class does the rest.

    All changing quantities are tensors in `state`, by name, so an interrupted training continues exactly. All random
    draws come from `generator`.

    Attributes:
        observation_size: numbers that the policy sees.
        privileged_size: further numbers that the critic sees; may be 0.
        action_size: numbers of an action, each within ±1.
        period: between two actions, s.
        episode_steps: after which an episode is truncated.
        batch: machines.
        device: where all tensors are.
        state: what changes from step to step.
        generator: of all draws, on the device.
        captured: whether a step asks nothing of the device, and may become a CUDA graph. A step then works on all
            machines and chooses among them by masks; elsewhere it works on those that it concerns.
    """

    observation_size: ClassVar[int]
    privileged_size: ClassVar[int]
    action_size: ClassVar[int]
    period: float
    episode_steps: int

    def __init__(self, batch: int, device: torch.device | str = "cpu") -> None:
        self.batch = batch
        self.device = torch.device(device)
        self.generator = torch.Generator(self.device)
        self.state: dict[str, Tensor] = {}
        self.captured = False

    @abstractmethod
    def reset(self, machines: Tensor) -> None:
        """Put some machines where an episode of theirs starts.

        Args:
            machines: indices, (machines,), or where steps are `captured` a mask, (batch,) bool.
        """

    @abstractmethod
    def advance(self, action: Tensor) -> tuple[Tensor, Tensor]:
        """Let all machines act for a period.

        Args:
            action: (batch, action_size), within ±1.

        Returns:
            The reward (batch,), and whether the episode terminated, (batch,) bool.
        """

    @abstractmethod
    def observe(self, machines: Machines = slice(None)) -> Observation:
        """Return what is seen of some machines now."""

    def schedule(self, share: float) -> None:  # noqa: B027 - most environments stay as they are
        """Become harder as training goes on; called before each iteration.

        Args:
            share: of the training that is done, 0 to 1.
        """

    def measures(self) -> dict[str, float]:
        """Return what is to stand in the learning curve, of what happened since this was last asked."""
        return {}

    @torch.no_grad()
    def start(self, seed: int) -> Observation:
        """Put every machine where an episode starts and return what is seen; the seed fixes all that follows."""
        self.generator.manual_seed(seed)
        self.state = {_AGE: torch.zeros(self.batch, dtype=torch.int32, device=self.device)}
        self.reset(torch.arange(self.batch, device=self.device))
        return self.observe()

    @torch.no_grad()
    def step(self, action: Tensor) -> Transition:
        """Let all machines act for a period; those whose episode ends start anew.

        Args:
            action: (batch, action_size); what is beyond ±1 counts as ±1.
        """
        reward, terminated = self.advance(action.clamp(-1.0, 1.0))
        age = self.state[_AGE]
        age += 1
        truncated = (age >= self.episode_steps) & ~terminated
        reached = self.observe()
        ended = terminated | truncated
        age.masked_fill_(ended, 0)
        observation = self._started_anew(ended, reached)
        return Transition(reached, reward, terminated, truncated, observation)

    def _started_anew(self, ended: Tensor, reached: Observation) -> Observation:
        """Start the episodes anew that ended, (batch,) bool, and return what is seen then."""
        if self.captured:
            self.reset(ended)
            return self.observe()
        machines = ended.nonzero()[:, 0]
        if not len(machines):
            return reached
        self.reset(machines)
        return reached.replaced(machines, self.observe(machines))

    def snapshot(self) -> dict[str, Tensor]:
        """Return all that the machines' future depends on, tensors on the CPU."""
        tensors = {name: tensor.detach().cpu().clone() for name, tensor in self.state.items()}
        return tensors | {_GENERATOR: self.generator.get_state()}

    def resume(self, snapshot: dict[str, Tensor]) -> Observation:
        """Go on where a snapshot was taken, and return what was seen there."""
        tensors = dict(snapshot)
        self.generator.set_state(tensors.pop(_GENERATOR))
        self.state = {name: tensor.clone().to(self.device) for name, tensor in tensors.items()}
        return self.observe()
