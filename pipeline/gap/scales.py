"""Typical sizes of a recording, in which the priors of parameters are measured.

A prior of an absolute width would decide by the unit that a machine is described in. What is a plausible friction
follows from how hard the machine was driven, a plausible stiffness from effort and travel.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from simgap.effects import Effect, Parameter, effects_of
from simgap.effects.sizes import POWERS, size_of
from simgap.equations.problem import Problem
from simgap.simulation import Simulator

_SHARE_OF_SIGNAL = 0.3
"""A law that is worth naming changes what drives the machine by some tenths; this is a width, not a bound."""
_REACTION = 0.02
"""Of delays and lags, s: what buses, filters and motor controllers take, however slow the machine."""
_WINDING = 2e-3
"""Of windings, inductance over resistance, s: 0.1 ms of a coreless motor to 10 ms of a large one in data sheets."""
_REST_SPREADS, _REST_SHARE = 3.0, 0.1
"""A driver rests within some of its own changes of where it was recorded, or a tenth of its usual size."""


@dataclass(frozen=True)
class Scales:
    """Sizes of what was recorded.

    Attributes:
        sizes: of effort, travel, speed and so on, see `simgap.effects.sizes`.
        drivers: mean and spread of the slow signals, by name.
    """

    sizes: Mapping[str, float]
    drivers: Mapping[str, tuple[float, float]]

    def driver(self, effect: Effect, parameter: Parameter) -> tuple[float, float]:
        """Return where the driver of an effect rests, and how far that may be off: it was recorded at work."""
        mean, spread = self.drivers.get(effect.driver, (parameter.default, 0.0))
        return mean, _REST_SPREADS * spread + _REST_SHARE * abs(parameter.default)

    def of(self, unit: str) -> float | None:
        """Return the size of a parameter of this unit where its law is worth a share of the signals.

        None where the recording has no size for the unit, or where the parameter is a number of the machine that no
        signal has a share in (cycles per turn).
        """
        if unit == "s":
            return _REACTION
        powers = POWERS.get(unit)
        if powers is None or unit.startswith("1/") or not set(powers) <= set(self.sizes):
            return None
        share = _WINDING if unit == "H" else _SHARE_OF_SIGNAL
        return share * size_of(unit, self.sizes)


def scales_of(simulator: Simulator, problem: Problem) -> Scales:
    """Return the sizes of what a recording holds."""
    signals = problem.blocks.signals
    names = {effect.driver for effect in effects_of(simulator.platform.kind)} & set(signals)
    drivers = {name: (float(signals[name].mean()), float(signals[name].std())) for name in names}
    return Scales(problem.sizes, drivers)
