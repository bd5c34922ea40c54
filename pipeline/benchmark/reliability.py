"""Calibration of stated probabilities: Brier score, expected calibration error, reliability diagram."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from simgap.benchmark.intervals import Share

BINS = 10

_DRAWS = 1000  # of outcomes, for the calibration error by chance

_SIZE, _LEFT, _TOP = 320, 60, 30  # px


@dataclass(frozen=True)
class Bin:
    """Statements of about the same probability.

    Attributes:
        stated: their mean probability.
        kept: share that is true.
    """

    stated: float
    kept: Share


def brier_score(stated: Sequence[tuple[float, bool]]) -> float:
    """Return the mean squared error of probabilities (Brier 1950, Monthly Weather Review 78)."""
    return sum((p - true) ** 2 for p, true in stated) / len(stated) if stated else math.nan


def reliability(stated: Sequence[tuple[float, bool]]) -> list[Bin]:
    """Return the bins of equal width that hold any statement."""
    bins = []
    for place in range(BINS):
        mine = [(p, true) for p, true in stated if min(int(p * BINS), BINS - 1) == place]
        if mine:
            share = Share(sum(true for _, true in mine), len(mine))
            bins.append(Bin(sum(p for p, _ in mine) / len(mine), share))
    return bins


def calibration_error(stated: Sequence[tuple[float, bool]]) -> float:
    """Return the expected calibration error: |stated − true share|, averaged over bins by their size.

    Source: Naeini, Cooper & Hauskrecht 2015, Obtaining well calibrated probabilities using Bayesian binning (AAAI).
    """
    bins = reliability(stated)
    total = sum(entry.kept.total for entry in bins)
    return (
        sum(entry.kept.total * abs(entry.stated - entry.kept.value) for entry in bins) / total
        if total
        else math.nan
    )


def calibration_error_by_chance(stated: Sequence[tuple[float, bool]]) -> float:
    """Return the mean calibration error of perfectly calibrated probabilities.

    It is above zero for any finite number of statements: a small bin cannot contain exactly the stated share.
    """
    if not stated:
        return math.nan
    random = np.random.default_rng(0)
    probabilities = [p for p, _ in stated]
    drawn = random.uniform(size=(_DRAWS, len(stated))) < np.array(probabilities)
    errors = [calibration_error(list(zip(probabilities, row, strict=True))) for row in drawn.tolist()]
    return float(np.mean(errors))


def reliability_figure(stated: Sequence[tuple[float, bool]]) -> str:
    """Draw the share that is true over the stated probability, with 95 % intervals, as the text of an SVG file."""
    bottom = _TOP + _SIZE
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{_LEFT + _SIZE + 30}" height="{bottom + 50}"'
        ' font-family="sans-serif" font-size="12">',
        '<rect width="100%" height="100%" fill="white"/>',
        f'<rect x="{_LEFT}" y="{_TOP}" width="{_SIZE}" height="{_SIZE}" fill="none" stroke="#888"/>',
        f'<line x1="{_LEFT}" y1="{bottom}" x2="{_LEFT + _SIZE}" y2="{_TOP}" stroke="#888" stroke-dasharray="4"/>',
        f'<text x="{_LEFT + _SIZE / 2}" y="{bottom + 38}" text-anchor="middle">stated probability</text>',
        f'<text transform="translate(16 {_TOP + _SIZE / 2}) rotate(-90)" text-anchor="middle">share that is there'
        "</text>",
        *_ticks(bottom),
    ]
    for entry in reliability(stated):
        x = _LEFT + _SIZE * entry.stated
        low, high = (bottom - _SIZE * value for value in entry.kept.interval)
        title = f"<title>{entry.kept.text} at {entry.stated:.2f}</title>"
        parts.append(f'<line x1="{x:.1f}" y1="{low:.1f}" x2="{x:.1f}" y2="{high:.1f}" stroke="#1f6f8b"/>')
        y = bottom - _SIZE * entry.kept.value
        parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4.5" fill="#1f6f8b">{title}</circle>')
        parts.append(f'<text x="{x - 8:.1f}" y="{y - 6:.1f}" text-anchor="end">{entry.kept.total}</text>')
    return "\n".join([*parts, "</svg>"]) + "\n"


def _ticks(bottom: int) -> list[str]:
    parts = []
    for tenth in range(0, 11, 2):
        x, y = _LEFT + _SIZE * tenth / 10, bottom - _SIZE * tenth / 10
        parts.append(f'<text x="{x}" y="{bottom + 16}" text-anchor="middle">{tenth / 10}</text>')
        parts.append(f'<text x="{_LEFT - 6}" y="{y + 4}" text-anchor="end">{tenth / 10}</text>')
    return parts
