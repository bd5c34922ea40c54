"""How strongly concealed effects show, and the strengths at which they would be near the noise."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

FAINT = 1.0
"""Energy of a faint effect over the noise's: neither hidden in it nor far above."""


def strengths_text(entries: Sequence[Mapping[str, Any]]) -> str:
    """Return a line per effect and machine: by strength the energy explained and what is left, then what is faint."""
    lines = []
    for entry in entries:
        cells = [f"{s}: {e['explained']:.2g} ({e['left']:.2g} left)" for s, e in entry["energies"].items()]
        faint = f"faint at {faint_strength(entry):.2g}"
        lines.append(f"{entry['kind']} {entry['effect']} {entry['machine']}: {', '.join([*cells, faint])}")
    return "\n".join(lines)


def faint_strength(entry: Mapping[str, Any]) -> float:
    """Return the strength whose energy would be `FAINT` times the noise's; not a number where nothing shows.

    The energy that an effect adds to the residual grows with about the square of its strength: the measurement that is
    nearest to faint counts.
    """
    showing = [(float(s), e["explained"]) for s, e in entry["energies"].items() if e["explained"] > 0]
    if not showing:
        return math.nan
    strength, energy = min(showing, key=lambda pair: abs(math.log(pair[1] / FAINT)))
    return strength * math.sqrt(FAINT / energy)
