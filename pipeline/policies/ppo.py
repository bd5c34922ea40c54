"""Proximal policy optimisation (Schulman et al. 2017, arXiv 1707.06347), by the losses of torchrl."""

import warnings

import torch
from tensordict import TensorDict
from tensordict.nn import ProbabilisticTensorDictModule, ProbabilisticTensorDictSequential, TensorDictModule
from torch import Tensor, nn
from torch.distributions import Independent, Normal

from simgap.policies.environment import Environment
from simgap.policies.networks import Critic, Gaussian
from simgap.policies.settings import Learning

with warnings.catch_warnings():  # of parts of torchrl that are not used here
    warnings.simplefilter("ignore")
    from torchrl.objectives import ClipPPOLoss
    from torchrl.objectives.value.functional import generalized_advantage_estimate

_LOSSES = ("loss_objective", "loss_critic", "loss_entropy")
_TOLD = ("kl_approx", "clip_fraction", "entropy", "loss_critic")


class Learner:
    """The networks and what changes them.

    Attributes:
        gaussian: from which actions are drawn.
        critic: sees what the policy sees, and the privileged observation.
        optimizer: Adam.
        generator: of the actions and the minibatches, on the environment's device.
    """

    def __init__(self, environment: Environment, settings: Learning, seed: int) -> None:
        self.settings = settings
        self.device = environment.device
        with torch.random.fork_rng(devices=[]):
            torch.manual_seed(seed)
            self.gaussian, self.critic = networks(environment, settings)
        self.generator = torch.Generator(self.device).manual_seed(seed)
        self._loss = _loss(self.gaussian, self.critic, settings).to(self.device)
        self._parameters = [*self.gaussian.parameters(), *self.critic.parameters()]
        self.optimizer = self._optimizer()

    def _optimizer(self) -> torch.optim.Adam:
        return torch.optim.Adam(self._parameters, lr=self.settings.learning_rate, fused=True)

    def learn(self, steps: TensorDict, share: float) -> dict[str, float]:
        """Improve policy and critic by a segment; return what stands in the learning curve.

        Args:
            steps: of a `Segment`.
            share: of the training that is done, 0 to 1.
        """
        settings = self.settings
        rate = _interpolated(settings.learning_rate, settings.final_learning_rate, share)
        self._loss.entropy_coeff.fill_(_interpolated(settings.entropy, settings.final_entropy, share))
        self._learn_at(rate)
        samples = self._at_their_place(self._samples(steps))
        told: list[Tensor] = []
        for _ in range(settings.epochs):
            order = torch.randperm(len(samples), generator=self.generator, device=self.device)
            told += [self._improve_by(samples, part) for part in order.split(settings.minibatch)]
        means = torch.stack(told).mean(0).tolist()
        deviation = float(self.gaussian.log_deviation.detach().exp().mean())
        return {**dict(zip(_TOLD, means, strict=True)), "deviation": deviation, "learning_rate": rate}

    def _samples(self, steps: TensorDict) -> TensorDict:
        """Return the steps in one row, with the generalised advantage estimate, of mean 0 and deviation 1."""
        advantage, target = generalized_advantage_estimate(
            self.settings.discount,
            self.settings.trace,
            steps["value"],
            steps["next_value"],
            steps["reward"] * self.settings.reward_scale,
            steps["done"],
            steps["terminated"],
            time_dim=0,
        )
        kept = steps.select("observation", "privileged", "action", "action_log_prob")
        kept["advantage"] = (advantage - advantage.mean()) / (advantage.std() + 1e-8)
        kept["value_target"] = target
        return kept.flatten()

    def _learn_at(self, rate: float) -> None:
        for group in self.optimizer.param_groups:
            group["lr"] = rate

    def _at_their_place(self, samples: TensorDict) -> TensorDict:
        """Return the samples where they are learnt from."""
        return samples

    def _improve_by(self, samples: TensorDict, part: Tensor) -> Tensor:
        """Take a step of the optimiser by some of the samples, indices (minibatch,)."""
        return self._improve(samples[part])

    def _improve(self, minibatch: TensorDict) -> Tensor:
        losses = self._loss(minibatch)
        loss = sum(losses[name] for name in _LOSSES)
        self.optimizer.zero_grad()
        loss.backward()
        nn.utils.clip_grad_norm_(self._parameters, self.settings.gradient_norm)
        self.optimizer.step()
        return torch.stack([losses[name].detach() for name in _TOLD])

    def snapshot(self) -> dict[str, object]:
        """Return all that the learning to come depends on."""
        return {
            "gaussian": self.gaussian.state_dict(),
            "critic": self.critic.state_dict(),
            "optimizer": self.optimizer.state_dict(),
            "generator": self.generator.get_state(),
        }

    def resume(self, snapshot: dict[str, object]) -> None:
        """Go on where a snapshot was taken."""
        for name in ("gaussian", "critic", "optimizer"):
            getattr(self, name).load_state_dict(snapshot[name])
        self.generator.set_state(snapshot["generator"])  # type: ignore[arg-type]


def _interpolated(start: float, end: float, share: float) -> float:
    return (1.0 - share) * start + share * end


def networks(environment: Environment, settings: Learning) -> tuple[Gaussian, Critic]:
    """Return policy and critic of the sizes that an environment asks for, on its device."""
    seen, hidden, slope = environment.observation_size, settings.hidden, settings.slope
    gaussian = Gaussian(seen, environment.action_size, hidden, slope, settings.deviation)
    critic = Critic(seen, environment.privileged_size, hidden, slope)
    return gaussian.to(environment.device), critic.to(environment.device)


class _PPOLoss(ClipPPOLoss):
    """The loss of torchrl, without its question to the device whether the entropy is finite: that of normals is."""

    def _get_entropy(self, dist: Independent, adv_shape: torch.Size) -> Tensor:
        return dist.entropy().unsqueeze(-1)


def _loss(gaussian: Gaussian, critic: Critic, settings: Learning) -> ClipPPOLoss:
    distribution = ProbabilisticTensorDictModule(
        in_keys=["loc", "scale"],
        out_keys=["action"],
        distribution_class=_distribution,
        return_log_prob=True,
    )
    mean = TensorDictModule(gaussian, in_keys=["observation"], out_keys=["loc", "scale"])
    value = TensorDictModule(critic, in_keys=["observation", "privileged"], out_keys=["state_value"])
    loss = _PPOLoss(
        ProbabilisticTensorDictSequential(mean, distribution),
        value,
        clip_epsilon=settings.clip,
        entropy_coeff=settings.entropy,
        critic_coeff=settings.critic,
        loss_critic_type="l2",
        functional=False,
    )
    loss.set_keys(sample_log_prob="action_log_prob")
    return loss


def _distribution(loc: Tensor, scale: Tensor) -> Independent:
    return Independent(Normal(loc, scale, validate_args=False), 1, validate_args=False)
