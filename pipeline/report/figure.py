"""What all figures share: plotly figures as plain data, coloured by the page's style sheet.

A colour is the name of a variable of the style sheet (`var(--before)`); the page's script replaces it when it
draws, so that the light, the dark and the printed page each have their own. Numbers travel as base64 of
float32, which plotly reads as it is and which needs a third less room than digits.
"""

import base64
import html
import json
import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from markupsafe import Markup
from numpy.typing import ArrayLike

from simgap.report.text import Real

INK, FAINT, GRID = "var(--ink)", "var(--faint)", "var(--grid)"
BEFORE, AFTER, FLOOR = "var(--before)", "var(--after)", "var(--floor)"
BEFORE_BAND, AFTER_BAND = "var(--before-band)", "var(--after-band)"
LONGEST_LABEL = 34  # characters


@dataclass(frozen=True)
class Figure:
    """One plotly figure.

    Attributes:
        caption: what it shows, as a sentence; stands above the figure.
        data: plotly traces.
        layout: plotly layout, from `layout`.
        height: pixels.
    """

    caption: str
    data: list[dict[str, Any]]
    layout: dict[str, Any] = field(default_factory=dict)
    height: int = 340

    @property
    def json(self) -> Markup:
        """The figure as JSON that is safe inside a script element."""
        return script_json({"data": self.data, "layout": self.layout})


def script_json(content: Any) -> Markup:
    """Write JSON in which no text can end the script element that holds it."""
    text = json.dumps(content, ensure_ascii=True, allow_nan=False, separators=(",", ":"))
    return Markup(text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026"))


def encode(values: ArrayLike) -> dict[str, str]:
    """Encode numbers of shape (n,) or (rows, columns) for plotly; None and infinities become gaps."""
    array = np.asarray(values, dtype=np.float64)
    array = np.where(np.isfinite(array), array, np.nan).astype("<f4")
    coded = {"dtype": "f4", "bdata": base64.b64encode(array.tobytes()).decode("ascii")}
    return coded if array.ndim == 1 else coded | {"shape": ", ".join(map(str, array.shape))}


def label(text: object, longest: int = LONGEST_LABEL) -> str:
    """Write text so that plotly, which reads some HTML in it, shows it as it is; shortened if need be."""
    words = " ".join(str(text).split())
    return html.escape(words if len(words) <= longest else f"{words[: longest - 1]}…", quote=False)


def axis(title: str = "", **settings: Any) -> dict[str, Any]:
    """Return an axis in the style of the page."""
    plain = {
        "title": {"text": label(title, 60), "standoff": 8},
        "automargin": True,
        "gridcolor": GRID,
        "linecolor": GRID,
        "zerolinecolor": GRID,
        "ticks": "outside",
        "tickcolor": GRID,
    }
    return plain | settings


def layout(x: dict[str, Any], y: dict[str, Any], **settings: Any) -> dict[str, Any]:
    """Return a layout in the style of the page, with one pair of axes."""
    plain = {
        "xaxis": x,
        "yaxis": y,
        "font": {"color": INK, "size": 12, "family": "system-ui, sans-serif"},
        "paper_bgcolor": "rgba(0,0,0,0)",
        "plot_bgcolor": "rgba(0,0,0,0)",
        "margin": {"l": 56, "r": 16, "t": 52, "b": 44},
        "legend": {"orientation": "h", "x": 0, "y": 1, "yanchor": "bottom", "xanchor": "left"},
        "hoverlabel": {"namelength": -1},
        "modebar": {"bgcolor": "rgba(0,0,0,0)", "color": FAINT, "activecolor": INK},
        "hovermode": "closest",
    }
    return plain | settings


def line(x: ArrayLike, y: ArrayLike, name: str, colour: str, **settings: Any) -> dict[str, Any]:
    """Return a line through points, in the order given; `dash` and `width` style it."""
    stroke = {"color": colour, "width": settings.pop("width", 2), "dash": settings.pop("dash", "solid")}
    return {
        "type": "scatter",
        "mode": "lines",
        "x": encode(x),
        "y": encode(y),
        "name": name,
        "line": stroke,
    } | settings


def band(x: Sequence[Real], low: Sequence[Real], high: Sequence[Real], colour: str) -> dict[str, Any]:
    """Return the area between two curves over x, as one closed polygon."""
    around = [*x, *list(x)[::-1]]
    edge = [*high, *list(low)[::-1]]
    return {
        "type": "scatter",
        "mode": "lines",
        "x": encode(around),
        "y": encode(edge),
        "fill": "toself",
        "fillcolor": colour,
        "line": {"width": 0},
        "hoverinfo": "skip",
        "showlegend": False,
    }


def distances(centre: Sequence[Real | None], low: Sequence, high: Sequence) -> dict[str, Any]:
    """Return error bars from bounds; a bound that is not known has none."""

    def length(value: Real | None, bound: Real | None, sign: int) -> float:
        known = value is not None and bound is not None and math.isfinite(value) and math.isfinite(bound)
        return max(sign * (bound - value), 0.0) if known else math.nan  # type: ignore[operator]

    above = [length(value, bound, 1) for value, bound in zip(centre, high, strict=True)]
    below = [length(value, bound, -1) for value, bound in zip(centre, low, strict=True)]
    return {"type": "data", "symmetric": False, "array": encode(above), "arrayminus": encode(below)}
