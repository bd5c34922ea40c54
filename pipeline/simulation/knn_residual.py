"""Nearest-neighbour model of the force and torque residuals of a simulator.

Kaufmann et al. 2023, "Champion-level drone racing using deep reinforcement learning", Nature 620, Methods: the residual
at a state is the mean of those at the k = 5 nearest of about a thousand recorded states.
"""

from dataclasses import dataclass
from functools import cached_property

import torch
from jaxtyping import Float
from torch import Tensor

from simgap.effects import WrenchEffect
from simgap.effects.effect import Signals, Values
from simgap.errors import InputError
from simgap.physics.shapes import Channels, Real, Vector
from simgap.platforms import Quadrotor

_AT_ONCE = 512  # queries whose distances to all samples stay in the cache of a processor


class HeldResidual(WrenchEffect):
    """A residual force and torque, constant over a control period."""

    linear = False
    name = "held_residual"
    kind = "quadrotor"
    acts_on = "force"
    parameters = ()
    needs = ("residual",)
    formula = "a = a_physics + residual_force, τ = τ_physics + residual_torque"
    source = "Kaufmann et al. 2023, Champion-level drone racing using deep reinforcement learning, Methods"
    sentence = "What the physics leaves over is looked up among recorded residuals."
    excitation = "the flights that the policy will fly"

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return specific force, m/s², and torque, N·m."""
        residual = signals["residual"]
        names = [f"{group}_{axis}" for group in ("force", "torque") for axis in "xyz"]
        return {name: residual[..., index] for index, name in enumerate(names)}


class RecordedResidual(WrenchEffect):
    """The residual of a recording, as part of a simulator.

    In a policy's flight it is evaluated once per control period, see `HeldResidual`; otherwise at every instant.

    Attributes:
        neighbours: from `residual_features` to specific force, m/s², (batch, 3).
    """

    linear = False
    name = "recorded_residual"
    kind = "quadrotor"
    acts_on = "force"
    parameters = ()
    needs = ("body_rate",)
    formula = "a = a_physics + mean of the residuals at the nearest recorded (velocity, body rate, commanded thrust)"
    source = "Kaufmann et al. 2023, Champion-level drone racing using deep reinforcement learning, Methods"
    sentence = "What the physics leaves over is looked up among recorded residuals."
    excitation = "the flights that the policy will fly"
    names_physics = False

    def __init__(self, neighbours: "NearestNeighbours", platform: Quadrotor) -> None:
        self.neighbours, self._platform = neighbours, platform

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return specific force, m/s²."""
        thrust = commanded_thrust(signals, self._platform)[..., None]
        force = self(residual_features(signals["velocity"], signals["body_rate"], thrust))
        return {f"force_{axis}": force[..., index] for index, axis in enumerate("xyz")}

    def __call__(self, features: Float[Tensor, "*#batch 7"]) -> Vector:
        """Return specific force, (..., 3) m/s², by `residual_features` (..., 7)."""
        if self.neighbours.inputs.device != features.device:
            self.neighbours = self.neighbours.to(features.device)
        flat = features.reshape(-1, features.shape[-1]).to(self.neighbours.inputs)
        return self.neighbours(flat).to(features).unflatten(0, features.shape[:-1])


def commanded_thrust(signals: Signals, platform: Quadrotor) -> Real:
    """Return the commanded thrust over mass by the platform's coefficients, (...,) m/s².

    Args:
        signals: `motor_command`, or `rotor_speed` where there is no command.
        platform: the platform with these coefficients.
    """
    known = signals.get("motor_command")
    speed = signals["rotor_speed"] if known is None else platform.motor_speed_max * known
    return platform.thrust_coefficient / platform.mass * speed.square().sum(-1)


@dataclass(frozen=True)
class NearestNeighbours:
    """Mean of the recorded residuals at the nearest samples.

    Attributes:
        inputs: (samples, features); each feature is measured in its standard deviation over the samples.
        outputs: (samples, channels).
        count: of neighbours.
    """

    inputs: Float[Tensor, "samples features"]
    outputs: Float[Tensor, "samples channels"]
    count: int = 5

    def __post_init__(self) -> None:
        """Check that there are enough samples and that every feature varies.

        Raises:
            InputError: when there are fewer samples than neighbours, or a feature that never changes.
        """
        if len(self.inputs) < self.count or len(self.inputs) != len(self.outputs):
            raise InputError(
                "too few samples, or not one output for each", "residual", f"record at least {self.count}"
            )
        if not bool((self.inputs.std(0) > 0).all()):
            raise InputError("a feature never changes", "residual", "leave it out")

    @cached_property
    def _unit(self) -> tuple[Tensor, Tensor]:
        return self.inputs.mean(0), self.inputs.std(0)

    @cached_property
    def _samples(self) -> tuple[Tensor, Tensor]:
        middle, size = self._unit
        scaled = (self.inputs - middle) / size
        return -0.5 * scaled.square().sum(1), scaled.T.contiguous()

    def to(self, device: torch.device | str) -> "NearestNeighbours":
        """Return the samples on a device."""
        return NearestNeighbours(self.inputs.to(device), self.outputs.to(device), self.count)

    def __call__(self, queries: Float[Tensor, "batch features"]) -> Float[Tensor, "batch channels"]:
        """Return the mean outputs at the nearest samples, (batch, channels).

        Args:
            queries: (batch, features).
        """
        middle, size = self._unit
        parts = ((queries - middle) / size).split(_AT_ONCE if queries.device.type == "cpu" else len(queries))
        return torch.cat([self._mean_of_nearest(part) for part in parts])

    def _mean_of_nearest(self, scaled: Tensor) -> Tensor:
        halves, samples = self._samples
        # The nearest sample s of a query q has the greatest q·s − s²/2, since q² is the same for all.
        nearness = torch.addmm(halves, scaled, samples)
        nearest = nearness.topk(self.count, dim=1, sorted=False).indices
        return self.outputs[nearest].mean(1)


def residual_features(
    velocity: Vector, body_rate: Vector, action: Float[Tensor, "*#batch k"]
) -> Float[Tensor, "*#batch 7"]:
    """Return the features of a quadrotor's residual, (..., 7).

    Args:
        velocity: body frame, (..., 3) m/s.
        body_rate: (..., 3) rad/s.
        action: collective thrust over mass first, m/s², (..., k); what follows is not read.
    """
    return torch.cat([velocity, body_rate, action[..., :1]], dim=-1)
