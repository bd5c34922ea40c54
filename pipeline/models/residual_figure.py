"""The figure of one-step residuals, with histogram and density. Plain SVG: training needs no drawing library."""

from collections.abc import Mapping
from html import escape

import numpy as np

from simgap.artifacts import svg
from simgap.models.residual_density import ResidualDensity

_WIDTH, _HEIGHT, _LEFT, _TOP, _GAP, _COLUMNS = 400, 130, 20, 34, 50, 2  # px, of each output's panel
_BARS, _DENSITY, _UNCORRECTED = "histogram", "density", "uncorrected"
_COLOURS = {_BARS: "#b9cde5", _DENSITY: "#1f4e79", _UNCORRECTED: "#c0504d"}


def residual_figure(
    residuals: Mapping[str, np.ndarray], uncorrected: Mapping[str, np.ndarray], units: Mapping[str, str]
) -> str:
    """Draw a panel for each output, as the text of an SVG file.

    Args:
        residuals: recorded minus predicted next values by output, (samples,), in the output's unit.
        uncorrected: the same before a bias correction; empty if there was none.
        units: by output; those without one are drawn without it.
    """
    densities = {name: ResidualDensity.of(own, uncorrected.get(name)) for name, own in residuals.items()}
    colours = {name: colour for name, colour in _COLOURS.items() if uncorrected or name != _UNCORRECTED}
    width = _LEFT + (_WIDTH + _LEFT) * _COLUMNS
    parts = svg.legend(colours, _LEFT, width - _LEFT, "recorded minus predicted next value, held-out runs")
    for number, (output, density) in enumerate(densities.items()):
        row, column = divmod(number, _COLUMNS)
        left, top = _LEFT + (_WIDTH + _LEFT) * column, _TOP + (_HEIGHT + _GAP) * row
        parts += _panel(output, units.get(output, ""), density, left, top)
    rows = -(-len(densities) // _COLUMNS)
    return svg.document(width, _TOP + (_HEIGHT + _GAP) * rows, parts)


def _panel(output: str, unit: str, density: ResidualDensity | None, left: int, top: int) -> list[str]:
    """Return the frame and the name of an output, and what is known of its residuals."""
    bottom, name = top + _HEIGHT, f"{output} ({unit})" if unit else output
    frame = f'<rect x="{left}" y="{top}" width="{_WIDTH}" height="{_HEIGHT}" fill="none" stroke="#d9d9d9"/>'
    if density is None:
        return [frame, _text(left, bottom + 30, f"{name}: no residual is finite")]
    said = f"{name}: {density.mean:.2g} ± {density.std:.2g}, {density.outside} of {density.samples} not shown"
    return [
        *_curves(density, left, bottom),
        frame,
        _text(left, bottom + 15, f"{density.edges[0]:.3g}"),
        _text(left + _WIDTH, bottom + 15, f"{density.edges[-1]:.3g}", ' text-anchor="end"'),
        _text(left, bottom + 30, said),
    ]


def _curves(density: ResidualDensity, left: int, bottom: int) -> list[str]:
    """Return the histogram as one outline, the line of zero, and the densities."""
    low, high = density.edges[0], density.edges[-1]
    greatest = max(map(np.max, filter(len, (density.heights, density.density, density.uncorrected))))

    def points(x: np.ndarray, y: np.ndarray) -> str:
        places = left + (x - low) * _WIDTH / (high - low)
        heights = bottom - y * 0.95 * _HEIGHT / (greatest or 1.0)
        return " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(places, heights, strict=True))

    outline = points(
        np.repeat(density.edges, 2), np.concatenate([[0.0], np.repeat(density.heights, 2), [0.0]])
    )
    parts = [f'<polygon points="{outline}" fill="{_COLOURS[_BARS]}"/>']
    if low < 0.0 < high:
        zero = points(np.zeros(2), np.array([0.0, greatest / 0.95]))
        parts.append(f'<polyline points="{zero}" stroke="#808080" stroke-dasharray="3 3"/>')
    for name, values in ((_UNCORRECTED, density.uncorrected), (_DENSITY, density.density)):
        if len(values):
            line = points(density.grid, values)
            parts.append(f'<polyline points="{line}" fill="none" stroke="{_COLOURS[name]}"/>')
    return parts


def _text(x: int, y: int, words: str, more: str = "") -> str:
    return f'<text x="{x}" y="{y}"{more}>{escape(words)}</text>'
