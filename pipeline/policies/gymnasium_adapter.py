"""Gymnasium interface to one machine of an environment, for training with other libraries."""

from typing import Any

import gymnasium
import numpy as np
import torch
from numpy.typing import NDArray

from simgap.policies.environment import Environment

Numbers = NDArray[np.float32]


class GymnasiumEnvironment(gymnasium.Env[Numbers, Numbers]):
    """An environment of one machine (https://gymnasium.farama.org/api/env)."""

    metadata = {"render_modes": []}  # noqa: RUF012 - Gymnasium declares it so

    def __init__(self, environment: Environment) -> None:
        """Adapt an environment whose batch is one."""
        if environment.batch != 1:
            raise ValueError(f"the batch is {environment.batch}; Gymnasium's environment is one machine")
        seen, acted = (environment.observation_size,), (environment.action_size,)
        self.environment = environment
        self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, seen, np.float32)
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, acted, np.float32)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Numbers, dict[str, Any]]:
        """Start an episode; without a seed it is drawn."""
        super().reset(seed=seed)
        observation = self.environment.start(int(self.np_random.integers(2**31)))
        return observation.policy[0].cpu().numpy(), {}

    def step(self, action: Numbers) -> tuple[Numbers, float, bool, bool, dict[str, Any]]:
        """Act for a period; what is returned after the last step of an episode is where it ended."""
        given = torch.as_tensor(action, dtype=torch.float32, device=self.environment.device)
        transition = self.environment.step(given[None])
        return (
            transition.reached.policy[0].cpu().numpy(),
            float(transition.reward[0]),
            bool(transition.terminated[0]),
            bool(transition.truncated[0]),
            {},
        )
