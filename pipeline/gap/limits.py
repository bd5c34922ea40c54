"""Numbers of a platform that are wrong by more than a fit looks for."""

import math

from simgap.effects import ParameterError
from simgap.simulation import Simulator

_ON_LIMIT = 1e-3  # of a ratio, by which a fit may stay off its limit


def at_limits(simulator: Simulator) -> list[str]:
    """Return a sentence about each fitted ratio of a platform number that rests on a limit of the search."""
    found = []
    for fitted in simulator.free:
        if not isinstance(fitted.effect, ParameterError):
            continue
        ratio = fitted.effect.parameters[0]
        value = float(fitted.values[ratio.name])
        if min(abs(math.log(value / limit)) for limit in (ratio.low, ratio.high)) < _ON_LIMIT:
            found.append(
                f"{fitted.effect.name}: a ratio of {value:.3g} is the limit of what is looked for, so that the true "
                "one may lie beyond; multiply the number in the platform file by it, and run again"
            )
    return found
