"""Plain SVG, for figures of stages that need no drawing library."""

from collections.abc import Iterable, Mapping

_ENTRY = 110  # px from one entry of a legend to the next


def document(width: int, height: int, parts: Iterable[str]) -> str:
    """Return an SVG file with these elements on white, sizes in px. Text in them has to be escaped already."""
    begin = (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}"'
        ' font-family="sans-serif" font-size="12">'
    )
    return "\n".join([begin, '<rect width="100%" height="100%" fill="white"/>', *parts, "</svg>"]) + "\n"


def legend(colours: Mapping[str, str], left: int, right: int, note: str) -> list[str]:
    """Return a legend from `left` on, px, and a note that ends at `right`.

    Args:
        colours: by what they stand for.
        left: where it begins, px.
        right: where the note ends, px.
        note: beside it.
    """
    parts = [f'<text x="{right}" y="18" text-anchor="end">{note}</text>']
    for number, (name, colour) in enumerate(colours.items()):
        x = left + _ENTRY * number
        parts.append(f'<rect x="{x}" y="8" width="12" height="12" fill="{colour}"/>')
        parts.append(f'<text x="{x + 17}" y="18">{name}</text>')
    return parts
