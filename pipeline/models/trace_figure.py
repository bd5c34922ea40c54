"""The figure of a free run: measured and modelled traces. Plain SVG, so that training needs no drawing library."""

from html import escape

import numpy as np
import pandas as pd

from simgap.artifacts import svg

_WIDTH, _HEIGHT, _LEFT, _TOP, _GAP = 860, 150, 70, 34, 26  # px, of each state's panel
_COLOURS = {"measured": "#444444", "modelled": "#c0504d"}


def trace_figure(traces: pd.DataFrame) -> str:
    """Draw a panel for each state, as the text of an SVG file.

    Args:
        traces: as `free_run_traces` returns them.
    """
    states = list(dict.fromkeys(traces["state"]))
    height = _TOP + (_HEIGHT + _GAP) * len(states)
    span = f"{float(traces['t'].min()):.3g} to {float(traces['t'].max()):.3g} s"
    parts = svg.legend(_COLOURS, _LEFT, _LEFT + _WIDTH, span)
    for number, state in enumerate(states):
        parts += _panel(state, traces[traces["state"] == state], _TOP + number * (_HEIGHT + _GAP))
    return svg.document(_LEFT + _WIDTH + 10, height, parts)


def _panel(state: str, rows: pd.DataFrame, top: int) -> list[str]:
    """Return the frame, the range and both traces of a state; what is not finite is left out."""
    values = rows[list(_COLOURS)].to_numpy(float)
    finite = values[np.isfinite(values)]
    low, high = (float(finite.min()), float(finite.max())) if len(finite) else (0.0, 1.0)
    scale = _HEIGHT / (high - low or 1.0)
    time = rows["t"].to_numpy(float)
    x = _LEFT + (time - time[0]) * _WIDTH / (time[-1] - time[0] or 1.0)
    parts = [
        f'<rect x="{_LEFT}" y="{top}" width="{_WIDTH}" height="{_HEIGHT}" fill="none" stroke="#d9d9d9"/>',
        f'<text x="{_LEFT}" y="{top + _HEIGHT + 15}">{escape(state)}</text>',
        f'<text x="{_LEFT - 6}" y="{top + 11}" text-anchor="end">{high:.3g}</text>',
        f'<text x="{_LEFT - 6}" y="{top + _HEIGHT}" text-anchor="end">{low:.3g}</text>',
    ]
    for column, colour in enumerate(_COLOURS.values()):
        own = np.isfinite(values[:, column])
        y = top + _HEIGHT - (values[own, column] - low) * scale
        points = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x[own], y, strict=True))
        parts.append(f'<polyline points="{points}" fill="none" stroke="{colour}"/>')
    return parts
