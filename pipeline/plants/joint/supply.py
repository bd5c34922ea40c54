"""Supply and winding of a joint's motor: battery sag and heating."""

from dataclasses import dataclass

import numpy as np
import torch

from simgap.physics import batteries
from simgap.plants.concealment import Concealed
from simgap.plants.rotation import Array

_CELL_NOMINAL = 3.7  # V
_SERIES_SHARE = 0.6  # of the drop that comes at once
_RELAXATION = 4.0  # s in which the rest comes
_LEAST_CHARGE = 0.15  # of the emptiest run
AMBIENT = 25.0  # °C, at which the platform's numbers hold
_WARMEST_START = 75.0  # °C, of a run that follows hard work
_HEATING = 35.0  # K that typical work warms a winding by, in the end
_THERMAL_TIME = 40.0  # s, of a small motor's winding
COPPER_SHARE = 0.7  # of what warmth takes from a motor at standstill; the rest is lost by the magnets


@dataclass
class Battery:
    """A Thevenin circuit per run, whose charge a run of seconds does not change.

    Attributes:
        source: open-circuit voltage, (runs,) V.
        series: Ω.
        relaxed: Ω, of the pair of resistor and capacitor.
        relaxation: voltage over the pair, (runs,) V.
    """

    source: Array
    series: float
    relaxed: float
    relaxation: Array

    def voltage(self, current: Array, step: float) -> Array:
        """Return the voltage (runs,), V, under a current, A, and let the pair relax by a step, s."""
        self.relaxation = self.relaxation + (self.relaxed * current - self.relaxation) * (step / _RELAXATION)
        return self.source - self.relaxation - self.series * current


def battery_of(
    effects: Concealed, supply: float, current: float, runs: int, random: np.random.Generator
) -> Battery:
    """Return the battery of each run, from full down to nearly empty.

    Args:
        effects: `battery_sag` says how much of the supply typical work takes away, and how full the first run is.
        supply: nominal voltage, V.
        current: of typical work, A.
        runs: how many.
        random: the charge of each.
    """
    sags = "battery_sag" in effects
    fullest = effects.get("battery_sag", "charge") if sags else 0.8
    drop = (effects.get("battery_sag", "drop") if sags else 0.1) * supply / current
    charge = torch.from_numpy(random.uniform(min(_LEAST_CHARGE, fullest), fullest, runs))
    source = supply / _CELL_NOMINAL * batteries.open_circuit_voltage(charge).numpy()
    return Battery(source, _SERIES_SHARE * drop, (1.0 - _SERIES_SHARE) * drop, np.zeros(runs))


@dataclass
class Winding:
    """The temperature of a motor's winding, (runs,) °C.

    Attributes:
        temperature: now.
        work: current or effort of typical work.
    """

    temperature: Array
    work: float

    def warm(self, load: Array, step: float) -> None:
        """Let a load, in the unit of `work`, heat the winding for a step, s."""
        excess = _HEATING * (load / self.work) ** 2 - (self.temperature - AMBIENT)
        self.temperature = self.temperature + excess * (step / _THERMAL_TIME)


def kept_at_standstill(lost: Array) -> Array:
    """Return the share of its torque that a motor under a voltage keeps at standstill.

    Args:
        lost: what the coefficient of its derating, times how much warmer it is, gives.
    """
    return (1.0 - (1.0 - COPPER_SHARE) * lost) / (1.0 + COPPER_SHARE * lost)


def winding_of(work: float, runs: int, random: np.random.Generator) -> Winding:
    """Return the winding of each run, some cold, some warm from what went before."""
    return Winding(random.uniform(AMBIENT, _WARMEST_START, runs), work)
