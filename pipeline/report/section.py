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
        map_bins: regime bins up to which the map writes numbers into its cells.
        maps: maps open when the page is opened; the others are folded, as are more laws and steps than these:
        laws: residual laws open when the page is opened.
        competition_steps: steps of the competition open when the page is opened.
        detail_rows: rows listed per detailed table.
    """

    trace_samples: int = 60_000
    scatter_samples: int = 1_500
    map_bins: int = 9
    maps: int = 3
    laws: int = 6
    competition_steps: int = 3
    detail_rows: int = 200
