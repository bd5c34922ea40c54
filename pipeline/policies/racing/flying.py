"""Batched flight of quadrotors in one compiled loop."""

from dataclasses import replace
from typing import Any, Protocol, runtime_checkable

import torch
from torch import Tensor
from torch.utils import _pytree as tree

from simgap.effects import effect_by_key
from simgap.errors import InputError
from simgap.platforms import Quadrotor
from simgap.policies.racing.settings import Flying
from simgap.simulation import FittedEffect, Simulator
from simgap.simulation.controllers import Betaflight
from simgap.simulation.driver import without_driver
from simgap.simulation.flight import Flight, Residual, racing_flight
from simgap.simulation.fused import FusedStep, RowStep
from simgap.simulation.knn_residual import HeldResidual, RecordedResidual, residual_features
from simgap.simulation.motion import QuadrotorMotion

STATE = 13
PARTS = QuadrotorMotion.parts


def flight_in(simulator: Simulator, settings: Flying, residual: Residual | None = None) -> Flight:
    """Return a flight in a simulator, with what the settings add to it.

    Args:
        simulator: of a quadrotor; a residual that was recorded is held through each period. Where a model moves it or
            adds to its physics, the rate controller runs as often as the model.
        settings: what is added.
        residual: what the physics leaves over, where the simulator has none of its own.

    Raises:
        InputError: when the simulator is not of a quadrotor, an effect or its parameter is unknown, or a period is no
            multiple of a learned model's step.
    """
    platform, learned = simulator.platform, simulator.learned
    if not isinstance(platform, Quadrotor):
        raise InputError(f"a {platform.kind} cannot race", "platform", "choose a quadrotor: platform=racer")
    residual = _recorded(simulator) or residual
    physics = tuple(f for f in simulator.effects if not isinstance(f.effect, RecordedResidual))
    effects = (*physics, *(_known(key, values) for key, values in settings.effects.items()))
    options: dict[str, Any] = {
        "period": settings.period,
        "substeps": settings.substeps if learned is None else learned.steps_in(settings.period),
        "integrator": settings.integrator,
    }
    if settings.powertrain:
        flight = racing_flight(platform, effects, settings.time_constant, residual=residual, **options)
        return replace(flight, simulator=replace(flight.simulator, learned=learned))
    controller = Betaflight.tuned(platform, settings.time_constant)
    held = () if residual is None else (FittedEffect(HeldResidual(), {}, known=True),)
    idle = without_driver(simulator.with_effects(effects))
    acting = tuple(f for f in effects if f not in idle)
    return Flight(simulator.with_effects((*acting, *held)), controller, residual=residual, **options)


def left_out(simulator: Simulator, settings: Flying) -> list[str]:
    """Say which effects of a simulator are not flown, and why."""
    if settings.powertrain:
        return []
    return [
        f"{f.effect.name} is left out: nothing says what its {f.effect.driver} is; diagnose again, or set powertrain"
        for f in without_driver(simulator)
    ]


def _recorded(simulator: Simulator) -> Residual | None:
    """Return the force and the torque of a simulator's recorded residual, (batch, 6)."""
    found = simulator.of_type(RecordedResidual)
    if not found:
        return None
    (residual,) = (fitted.effect for fitted in found)
    assert isinstance(residual, RecordedResidual)
    return lambda features: torch.nn.functional.pad(residual(features), (0, 3))


def _known(key: str, values: dict[str, float]) -> FittedEffect:
    effect = effect_by_key("quadrotor", key)
    unknown = values.keys() - effect.defaults().keys()
    if unknown:
        raise InputError(
            f"has no parameter {sorted(unknown)[0]!r}",
            f"effects.{key}",
            f"see simgap effects quadrotor {key}",
        )
    return FittedEffect(effect, {**effect.defaults(), **effect.completed(values)}, known=True)


@runtime_checkable
class Flown(Protocol):
    """Machines as columns of one tensor (rows, batch), whose first 13 rows are their states."""

    def rows(self, state: Tensor) -> Tensor:
        """Return the rows of machines in states (batch, 13), as if they had hovered before."""

    def step(self, rows: Tensor, command: Tensor, further: Tensor | None = None) -> Tensor:
        """Return the rows a period later; see `Fleet.step`."""

    def believed(self, rows: Tensor) -> Tensor:
        """Return the states as the machines believe them to be, (13, batch): the first thing that a policy is told."""

    def angular_acceleration(self, rows: Tensor) -> Tensor:
        """Return the angular acceleration, (batch, 3) rad/s², as a critic is told it."""


class Fleet:
    """A flight that is compiled, for machines as columns of one tensor (rows, batch) of state and memory.

    What a learned model does cannot be compiled so: it runs operation by operation.

    Attributes:
        flight: of the simulator.
        compiled: whether it is.
    """

    def __init__(self, flight: Flight, device: torch.device | str = "cpu") -> None:
        self.flight = flight
        self.compiled = flight.simulator.learned is None
        level = torch.zeros(1, STATE)
        level[:, PARTS["attitude"].start] = 1.0
        hover = torch.tensor([[flight.simulator.platform.gravity, 0.0, 0.0, 0.0]])
        with torch.no_grad():
            _, memory = flight.step(level, hover)
            acting = flight.acting(level, hover)
        self._memory = tree.tree_map(lambda tensor: tensor.to(device), memory)
        step, repeats = flight.inner_step, flight.substeps
        self._step = (
            RowStep(step, level, self._memory, repeats)
            if not self.compiled
            else FusedStep(step, level, acting, self._memory, repeats)
        )

    def rows(self, state: Tensor) -> Tensor:
        """Return the rows of machines whose rotors and battery are as in hover.

        Args:
            state: (batch, 13), see `simgap.simulation.motion.QuadrotorMotion`.
        """
        leaves, shape = tree.tree_flatten(self._memory)
        spread = [leaf.expand(len(state), *leaf.shape[1:]) for leaf in leaves]
        regulating, effects = tree.tree_unflatten(spread, shape)
        if not self.compiled:
            effects = self._remembering(state)
        regulating = {**regulating, "rate": state[:, PARTS["body_rate"]]}
        return self._step.pack(state, (regulating, effects))

    @torch.no_grad()
    def _remembering(self, state: Tensor) -> Any:
        """Return the memory of machines that have always been in their states, in hover."""
        hover = state.new_tensor([self.flight.simulator.platform.gravity, 0.0, 0.0, 0.0])
        return self.flight.step(state, hover.expand(len(state), -1))[1][1]

    def step(self, rows: Tensor, command: Tensor, further: Tensor | None = None) -> Tensor:
        """Return the rows a period later.

        Args:
            rows: of the period before, contiguous.
            command: collective thrust over mass and body rates, (batch, 4) m/s² and rad/s.
            further: force over mass and torque, (batch, 6) m/s² and N·m, beside the flight's own residual.
        """
        acting = self.flight.acting(rows[:STATE].T, command)
        if further is not None:
            acting = torch.cat([command, acting[:, 4:] + further], dim=-1)
        return self._step(rows, acting.T.contiguous())

    def believed(self, rows: Tensor) -> Tensor:
        """Return the states (13, batch) as they are: a simulated machine knows where it is."""
        return rows[:STATE]

    def angular_acceleration(self, rows: Tensor) -> Tensor:
        """Return the angular acceleration as the rate controller filters it, (batch, 3) rad/s²."""
        _, (regulating, _) = self._step.unpack(rows)
        return regulating["slope"]


def features_of(rows: Tensor, command: Tensor) -> Tensor:
    """Return what residuals depend on, (batch, 7): velocity (body), body rate, thrust."""
    signals = QuadrotorMotion().signals(rows[:STATE].T)
    return residual_features(signals["velocity"], signals["body_rate"], command)


def state_of(rows: Tensor) -> dict[str, Tensor]:
    """Return position, attitude, velocity (world) and body rate that rows hold, each (batch, ...)."""
    return {name: rows[part].T for name, part in PARTS.items()}
