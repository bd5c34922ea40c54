"""A section of the page."""

from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Section:
    """A section of the page: what the template `sections/KEY.html` needs to write it.

    Attributes:
        key: names the template and the anchor.
        title: heading.
        content: what the template sees as `content`.
    """

    key: str
    title: str
    content: dict[str, Any] = field(default_factory=dict)


@dataclass
class Drawing:
    """How much of the evidence is drawn, which bounds the size of the page.

    Attributes:
        trace_samples: samples kept over all measured-against-simulated traces together.
        scatter_samples: points drawn per residual law.
        maps: maps open when the page is opened; the others are folded.
        laws: residual laws open when the page is opened; the others are folded.
        detail_rows: rows listed per detailed table.
    """

    trace_samples: int = 40_000
    scatter_samples: int = 800
    maps: int = 3
    laws: int = 6
    detail_rows: int = 200
