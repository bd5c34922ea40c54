"""Collection and learning as CUDA graphs, for environments whose steps are captured."""

from functools import partial

import torch
from tensordict import TensorDict
from torch import Tensor

from simgap.policies.collector import Collector, room
from simgap.policies.environment import Environment
from simgap.policies.networks import Critic, Gaussian
from simgap.policies.ppo import Learner
from simgap.policies.settings import Learning
from simgap.simulation.captured import Captured


class CapturedCollector(Collector):
    """Acts with one CUDA graph for a control step; each segment takes the place of the one before."""

    def __init__(self, environment: Environment, seed: int) -> None:
        super().__init__(environment, seed)
        self._place = torch.zeros(1, dtype=torch.int64, device=environment.device)
        self._for: tuple[object, ...] = ()
        self._room: TensorDict | None = None

    def _steps(
        self, gaussian: Gaussian, critic: Critic, horizon: int, generator: torch.Generator
    ) -> TensorDict:
        asked = (gaussian, critic, horizon, generator)
        if self._for != asked:
            self._for, self._room = asked, None
            generators = (generator, self.environment.generator)
            work = partial(self._write, gaussian, critic, horizon, generator)
            self._acting = Captured(work, generators, self.environment.device)
        self._place.zero_()
        for _ in range(horizon):
            self._acting()
        assert self._room is not None
        return self._room.clone(recurse=False)  # what others put in the place of its parts is not captured

    @torch.no_grad()
    def _write(self, gaussian: Gaussian, critic: Critic, horizon: int, generator: torch.Generator) -> None:
        """Let all machines act once, write it down at its place, and leave all that changes where it was."""
        state, seen = dict(self.environment.state), self.observation
        row = self._step(gaussian, critic, generator)
        self._room = room(row, horizon) if self._room is None else self._room
        for name, tensor in row.items():
            self._room.get(name).index_copy_(0, self._place, tensor[None])
        self._place += 1
        for name, kept in state.items():
            kept.copy_(self.environment.state[name])
        seen.policy.copy_(self.observation.policy)
        seen.privileged.copy_(self.observation.privileged)
        self.environment.state, self.observation = state, seen

    def resume(self, snapshot: dict[str, dict[str, Tensor]]) -> None:
        """Go on where a snapshot was taken; what changes has other places then."""
        super().resume(snapshot)
        self._for = ()


class CapturedLearner(Learner):
    """Learns with one CUDA graph for a step of the optimiser."""

    _samples_now: TensorDict | None
    _part: Tensor | None
    _told: Tensor | None

    def __init__(self, environment: Environment, settings: Learning, seed: int) -> None:
        self._rate = torch.tensor(settings.learning_rate, device=environment.device)
        super().__init__(environment, settings, seed)
        self._forget()

    def _optimizer(self) -> torch.optim.Adam:
        on_device = self.device.type == "cuda"
        return torch.optim.Adam(self._parameters, lr=self._rate, fused=True, capturable=on_device)

    def _learn_at(self, rate: float) -> None:
        self._rate.fill_(rate)
        for group in self.optimizer.param_groups:
            group["lr"] = self._rate

    def _at_their_place(self, samples: TensorDict) -> TensorDict:
        if self._samples_now is None or len(self._samples_now) != len(samples):
            self._forget()
            self._samples_now = samples.clone()
        else:
            self._samples_now.copy_(samples)
        return self._samples_now

    def _improve_by(self, samples: TensorDict, part: Tensor) -> Tensor:
        if self._part is None:
            self._part = part.clone()
        if len(part) != len(self._part):  # the last of a pass may be smaller
            return super()._improve_by(samples, part)
        self._part.copy_(part)
        self._improving()
        assert self._told is not None
        return self._told.clone()

    def _improve_here(self) -> None:
        assert self._samples_now is not None
        told = self._improve(self._samples_now[self._part])
        self._told = told if self._told is None else self._told.copy_(told)

    def resume(self, snapshot: dict[str, object]) -> None:
        """Go on where a snapshot was taken; what changes has other places then."""
        super().resume(snapshot)
        self._forget()

    def _forget(self) -> None:
        self._samples_now, self._part, self._told = None, None, None
        self._improving = Captured(self._improve_here, (), self.device)
