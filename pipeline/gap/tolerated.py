"""What a diagnosis says of effects that are too small for a name."""

import math
from collections.abc import Mapping
from typing import Any

from simgap.effects import ParameterError
from simgap.gap.name import Naming
from simgap.simulation import FittedEffect


def within_tolerance(naming: Naming, time_step: float) -> list[str]:
    """Return a sentence about each effect of the simulator that is too small for a name."""
    best = naming.best
    small = [f for f in best.fit.simulator.free if f.effect.key in best.doubtful - best.names]
    constants = best.fit.simulator.constants()
    return [
        f"{_smallness(f, constants, time_step)}; it stays in the simulator, but is not named" for f in small
    ]


def _smallness(fitted: FittedEffect, constants: Mapping[str, Any], time_step: float) -> str:
    """Return in what way an effect is too small for a name."""
    effect = fitted.effect
    if isinstance(effect, ParameterError):
        return f"{effect.name}: a ratio of {_farthest(fitted):.4g} is within what a fit can tell"
    share = effect.stands_for(fitted.values, constants)
    if share < math.inf:
        return f"{effect.name}: {share:.1%} of a number of the platform is within what that is known to"
    late = effect.lateness(fitted.values, constants)
    return (
        f"{effect.name}: {late:.2g} s is too short to be told from the timing of the commands, with samples "
        f"{time_step:.2g} s apart"
    )


def _farthest(fitted: FittedEffect) -> float:
    """Return the ratio that is farthest from 1."""
    return max((float(value) for value in fitted.values.values()), key=lambda ratio: abs(ratio - 1.0))
