"""The figure of cleaning: one time bar per run. Plain SVG, so that cleaning needs no drawing library."""

import itertools
from html import escape

import numpy as np
import pandas as pd

from simgap.artifacts import svg

_WIDTH, _BAR, _ROW, _LABEL, _TOP = 900, 14, 22, 220, 44  # px
_LEVELS = 5  # shades of a pixel's share of interpolated samples
_COLOURS = {"kept": "#4c9f70", "interpolated": "#e0a030", "dropped": "#c0504d", "missing": "#d9d9d9"}


def coverage_figure(coverage: pd.DataFrame) -> str:
    """Draw what became of every moment of each run, as the text of an SVG file.

    Args:
        coverage: with the columns `COVERAGE_COLUMNS`.
    """
    runs = list(coverage.groupby("run", sort=False))
    longest = max((float(rows["end"].max() - rows["start"].min()) for _, rows in runs), default=1.0)
    height = _TOP + _ROW * len(runs)
    parts = svg.legend(_COLOURS, _LABEL, _LABEL + _WIDTH, f"{longest:.4g} s")
    for number, (run, rows) in enumerate(runs):
        parts += _bar(str(run), rows, _TOP + number * _ROW, _WIDTH / max(longest, 1e-9))
    return svg.document(_LABEL + _WIDTH + 10, height, parts)


def _bar(run: str, rows: pd.DataFrame, top: int, scale: float) -> list[str]:
    parts = [f'<text x="{_LABEL - 8}" y="{top + 11}" text-anchor="end">{escape(run)}</text>']
    origin = float(rows["start"].min())
    for state in ("kept", "missing", "interpolated", "dropped"):
        drawn = (
            ("kept", "interpolated") if state == "kept" else (state,)
        )  # what is filled lies on what is kept
        shares = _shares(rows[rows["state"].isin(drawn)], origin, scale)
        colour = _COLOURS[state]
        for first, past, share in _steps(shares):
            title = f"<title>{state}</title>"
            parts.append(
                f'<rect x="{_LABEL + first}" y="{top}" width="{past - first}" height="{_BAR}" fill="{colour}"'
                f' fill-opacity="{share:.2g}">{title}</rect>'
            )
    return parts


def _shares(rows: pd.DataFrame, origin: float, scale: float) -> np.ndarray:
    """Return the share of each pixel that the stretches cover, rounded up to levels, shape (pixels,)."""
    edges = np.arange(_WIDTH + 1, dtype=float)
    start = (rows["start"].to_numpy() - origin) * scale
    end = (rows["end"].to_numpy() - origin) * scale
    covered = np.zeros(_WIDTH + 1)
    if len(rows):
        # stretches are ordered and apart: the length covered up to x grows with slope one inside them
        knots = np.stack([start, end], axis=1).ravel()
        grown = np.repeat(np.concatenate([[0.0], np.cumsum(end - start)]), 2)[1:-1]
        covered = np.interp(edges, knots, grown)
    return np.ceil(np.diff(covered) * _LEVELS - 1e-6).clip(0) / _LEVELS


def _steps(shares: np.ndarray) -> list[tuple[int, int, float]]:
    edges = [0, *(np.flatnonzero(np.diff(shares)) + 1).tolist(), len(shares)]
    return [(a, b, float(shares[a])) for a, b in itertools.pairwise(edges) if shares[a] > 0]
