"""Simulated driver signals of effects (battery voltage, temperature) for flights without a recording."""

from dataclasses import dataclass
from typing import Any

import torch
from torch import Tensor

from simgap.effects import ActuatorEffect, Effect
from simgap.effects.effect import Parameter, Signals, Values
from simgap.physics.shapes import Signal
from simgap.simulation.simulator import FittedEffect, Simulator


@dataclass(frozen=True)
class SimulatedDriver(ActuatorEffect):
    """A constant level minus an immediate drop with the load; a given driver signal is kept.

    It is not in the catalogue, because it models a recorded signal and no missing physics.

    Attributes:
        driven: the effect whose driver it simulates; it also defines the load.
    """

    driven: Effect

    order = -1  # before all that needs it
    name = "simulated_driver"
    acts_on = "actuator"
    parameters = (
        Parameter("level", "unit of the driver", 1.0, -1e9, 1e9),
        Parameter("giving", "unit of the driver per load", 0.0, 0.0, 1e9),
    )
    formula = "driver = level − giving · load"
    source = (
        "Chen & Rincón-Mora 2006, Accurate electrical battery model: its source and its series resistance"
    )
    sentence = "What drives it stands at {level} and falls by {giving} per load."
    excitation = "the motion that is to be simulated"
    names_physics = False

    @property
    def key(self) -> str:
        """The name, unique for each driver signal."""
        return f"simulated_{self.driven.driver}"

    def actuate(
        self, signals: Signals, values: Values, constants: Values, memory: Any, time_step: float
    ) -> tuple[dict[str, Signal], Any]:
        """Return the driver signal if it is not given."""
        if self.driven.driver in signals:
            return {}, None
        load = self.driven.load(signals, constants)
        if load is None:
            load = torch.zeros_like(next(iter(signals.values()))[..., 0])
        return {self.driven.driver: values["level"] - values["giving"] * load}, None


def with_drivers(simulator: Simulator, signals: Signals) -> Simulator:
    """Return a simulator with the mean driver signals of a recording, for use without one.

    Args:
        simulator: after a diagnosis.
        signals: (blocks, samples, ...), with the drivers.
    """
    others = [f for f in simulator.effects if not isinstance(f.effect, SimulatedDriver)]
    driven = {f.effect.driver: f.effect for f in others if f.effect.driver in signals}
    if not driven:
        return simulator.with_effects(tuple(others))
    constants = simulator.constants()
    moved = simulator.mechanism.actuate(dict(signals), constants)
    loads = {name: None if e.driver_is_late else e.load(moved, constants) for name, e in driven.items()}
    laws = [_law(effect, signals[name], loads[name]) for name, effect in driven.items()]
    return simulator.with_effects((*others, *laws))


def without_driver(simulator: Simulator) -> tuple[FittedEffect, ...]:
    """Return the effects without a driver signal, which therefore have no effect in a new simulation."""
    known = {f.effect.driven.driver for f in simulator.effects if isinstance(f.effect, SimulatedDriver)}
    return tuple(f for f in simulator.effects if f.effect.driver and f.effect.driver not in known)


def _law(effect: Effect, driver: Tensor, load: Tensor | None) -> FittedEffect:
    """Return the least-squares line of a driver over its load, with a drop of at least zero."""
    giving = 0.0
    if load is not None:
        apart = load - load.mean()
        giving = max(-float((apart * driver).sum() / apart.square().sum().clamp_min(1e-300)), 0.0)
    level = float(driver.mean() + (giving * load.mean() if load is not None else 0.0))
    return FittedEffect(SimulatedDriver(effect), {"level": level, "giving": giving}, known=True)
