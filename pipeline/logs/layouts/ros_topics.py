"""Which topics of a bag hold what."""

from collections.abc import Sequence

import numpy as np

from simgap.logs.log import Log


def topics_of(log: Log, *types: str) -> list[str]:
    """Return the topics of some types that hold signals, the type named first before the others."""
    present = [topic for topic in log.facts if any(name.startswith(f"{topic}/") for name in log.signals)]
    return [topic for kind in types for topic in present if log.facts[topic] == kind]


def has(log: Log, names: Sequence[str]) -> bool:
    """Whether all of some signals are there, with values."""
    return all(name in log.signals and np.isfinite(log.signals[name].values).any() for name in names)
