"""Starting values for effects whose cost has several local minima."""

import itertools
from collections.abc import Sequence


def scan(**values: Sequence[float]) -> list[dict[str, float]]:
    """Return every combination of the given parameter values."""
    return [dict(zip(values, chosen, strict=True)) for chosen in itertools.product(*values.values())]
