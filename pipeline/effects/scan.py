"""Starting values for effects whose cost has several valleys."""

import itertools
from collections.abc import Sequence


def scan(**values: Sequence[float]) -> list[dict[str, float]]:
    """Return every combination of the parameters' values."""
    return [dict(zip(values, chosen, strict=True)) for chosen in itertools.product(*values.values())]
