"""How strongly concealed effects show, as a table, and the strengths at which they would be near the noise."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

FAINT = 1.0
"""Energy of a faint effect over the noise's: neither hidden in it nor far above."""


def strengths_text(entries: Sequence[Mapping[str, Any]]) -> str:
    """Return a line per effect: energies by strength, machine by machine, and the strength that would be faint.

    The energy that an effect adds to the residual grows with about the square of its strength, so that the faint
    strength follows from the weakest that was measured. Over machines, the geometric mean counts.
    """
    lines = []
    for kind, effect in dict.fromkeys((entry["kind"], entry["effect"]) for entry in entries):
        mine = [e for e in entries if (e["kind"], e["effect"]) == (kind, effect)]
        strengths = sorted({float(s) for entry in mine for s in entry["energies"]})
        cells = [f"{s:g}: {_listed([e['energies'].get(f'{s:g}') for e in mine])}" for s in strengths]
        lines.append(f"{kind} {effect}  faint at {faint_strength(mine):.2g}  ({'; '.join(cells)})")
    return "\n".join(lines)


def faint_strength(entries: Sequence[Mapping[str, Any]]) -> float:
    """Return the strength whose energy would be `FAINT` times the noise's; not a number where nothing shows."""
    estimates = []
    for entry in entries:
        showing = [(float(s), energy) for s, energy in entry["energies"].items() if energy > 0]
        if showing:
            strength, energy = min(showing, key=lambda pair: abs(math.log(pair[1] / FAINT)))
            estimates.append(math.log(strength * math.sqrt(FAINT / energy)))
    return math.exp(sum(estimates) / len(estimates)) if estimates else math.nan


def _listed(energies: Sequence[float | None]) -> str:
    return " ".join("–" if energy is None else f"{energy:.2g}" for energy in energies)
