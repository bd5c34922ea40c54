"""What all figures share: lines, bands and points as plain data, which the page's own script draws as SVG.

A colour is the name of a variable of the style sheet (`var(--before)`), so that the light, the dark and the printed
page each have their own. Long series travel as 16-bit steps in base64, which is finer than any screen.
"""

import base64
import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from markupsafe import Markup
from numpy.typing import ArrayLike

from simgap.report.text import minus

INK = "var(--ink)"
BEFORE, AFTER, FLOOR = "var(--before)", "var(--after)", "var(--floor)"
BEFORE_BAND, AFTER_BAND = "var(--before-band)", "var(--after-band)"
LONGEST_LABEL = 60  # characters
_AS_TEXT = 40  # values up to which a series is written out
_STEPS = 65534  # of a 16-bit number; the last one, 65535, is a gap

Mark = dict[str, Any]
"""A line, band or set of points; see `line`, `band` and `points`."""


@dataclass(frozen=True)
class Figure:
    """One figure.

    Attributes:
        caption: what it shows, as a sentence; stands above the figure.
        x: title of the horizontal axis.
        y: title of the vertical axis.
        marks: what is drawn, the hindmost first.
        height: pixels.
        log: whether the vertical axis is logarithmic.
        zero: whether it shows zero.
    """

    caption: str
    x: str
    y: str
    marks: list[Mark]
    height: int = 320
    log: bool = False
    zero: bool = False

    @property
    def json(self) -> Markup:
        """The figure as JSON that is safe inside a script element."""
        panel = {"title": label(self.y), "marks": self.marks, "log": self.log, "zero": self.zero}
        return script_json({"x": label(self.x), "height": self.height, "panels": [panel]})


def script_json(content: Any) -> Markup:
    """Write JSON in which no text can end the script element that holds it."""
    text = json.dumps(content, ensure_ascii=True, allow_nan=False, separators=(",", ":"))
    return Markup(text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026"))


def encode(values: ArrayLike) -> list[float | None] | dict[str, Any]:
    """Encode numbers of shape (n,) for the page's script; None and infinities become gaps.

    Few are written out with six digits, many as 16-bit steps between the least and the greatest.
    """
    array = np.asarray(values, dtype=np.float64)
    known = np.isfinite(array)
    if len(array) <= _AS_TEXT:
        return [float(f"{value:.6g}") if there else None for value, there in zip(array, known, strict=True)]
    low, high = (array[known].min(), array[known].max()) if known.any() else (0.0, 0.0)
    step = (high - low) / _STEPS or 1.0
    steps = np.where(known, np.round((np.where(known, array, low) - low) / step), _STEPS + 1).astype("<u2")
    return {"u2": base64.b64encode(steps.tobytes()).decode("ascii"), "low": float(low), "step": float(step)}


def label(text: object, longest: int = LONGEST_LABEL) -> str:
    """Write text as a label of a figure: in one line, with the minus sign of print, shortened if need be."""
    words = minus(" ".join(str(text).split()))
    return words if len(words) <= longest else f"{words[: longest - 1]}…"


def line(x: ArrayLike, y: ArrayLike, name: str, colour: str, **style: Any) -> Mark:
    """Return a line through points, in the order given.

    Args:
        x: (n,).
        y: (n,); a gap breaks the line.
        name: for the legend.
        colour: of the style sheet.
        style: `width` in pixels, `dash`, `dot`: radius of a mark at each point, in pixels.
    """
    return {"kind": "line", "x": encode(x), "y": encode(y), "name": label(name), "colour": colour} | style


def band(x: ArrayLike, low: ArrayLike, high: ArrayLike, colour: str) -> Mark:
    """Return the area between two curves over x; all of shape (n,)."""
    return {"kind": "band", "x": encode(x), "low": encode(low), "high": encode(high), "colour": colour}


def points(
    x: ArrayLike, y: ArrayLike, name: str, colour: str, bounds: Sequence[ArrayLike] = (), **style: Any
) -> Mark:
    """Return points, with error bars between bounds where both are given; all of shape (n,).

    Args:
        x: (n,).
        y: (n,).
        name: for the legend.
        colour: of the style sheet.
        bounds: low and high ends of the error bars, or nothing.
        style: `dot`: radius in pixels, `opacity`, `hollow`, `silent`: not said when pointed at.
    """
    bars = dict(zip(("low", "high"), map(encode, bounds), strict=False))
    return (
        {"kind": "points", "x": encode(x), "y": encode(y), "name": label(name), "colour": colour}
        | bars
        | style
    )
