"""The pipeline of a branch as a picture: `python -m tools.pipeline_picture docs/images/pipeline.svg`."""

import sys
from pathlib import Path

from simgap.runner.pipeline import Step, steps

ROOT = Path(__file__).parents[1]

GROUPS = {"data": (0, 0), "simulator": (1, 1), "policy": (2, 3), "report": (4, 4)}
"""First and last column of every group."""

PLACES = {
    "configure": (0, 0, "config.yaml"),
    "record": (0, 1, "recording"),
    "clean": (0, 2, "recording"),
    "sysid": (1, 1, "parameters"),
    "train": (1, 2, "learned model"),
    "build_sim": (1, 3, "simulator"),
    "diagnose": (1, 4, "diagnosis, simulator"),
    "train_detector": (2, 0, "gate detector"),
    "profile": (2, 1, "planned motions"),
    "train_policy": (2, 2, "policy"),
    "evaluate": (2, 4, "laps in simulation"),
    "deploy": (3, 0, "flights in reality"),
    "identify_residual": (3, 1, "residuals"),
    "finetune": (3, 2, "policy"),
    "redeploy": (3, 3, "flights in reality"),
    "report": (4, 3, "report.html"),
}
"""Column, row and what each stage writes."""

_WIDTH, _HEIGHT = 134, 44  # of a box, px
_COLUMN, _ROW = 160, 64  # from one to the next
_LEFT, _TOP = 13, 44  # of the first box
_COLOURS = {"data": "#e8f1fa", "simulator": "#eaf5ea", "policy": "#fdf1e3", "report": "#f3ecf8"}
_STYLE = (
    "text{font-family:Helvetica,Arial,sans-serif;fill:#222}.n{font-size:14px;font-weight:600}.a{font-size:12px;"
    "fill:#555}.g{font-size:14px;fill:#555}path{fill:none;stroke:#555;stroke-width:1.5}"
)
_NOTE = "Every stage reads the configuration. Arrows that others imply are left out."


def arrows(pipeline: list[Step]) -> list[tuple[str, str]]:
    """Return which stage leads to which, without what follows from the others."""
    reads = {step.name: set(step.reads) for step in pipeline}
    before: dict[str, set[str]] = {}
    for step in pipeline:  # each stands behind all that it reads
        before[step.name] = reads[step.name].union(*(before[other] for other in reads[step.name]))
    return [
        (other, step.name)
        for step in pipeline
        for other in step.reads
        if not any(other in before[between] for between in reads[step.name])
    ]


def picture(pipeline: list[Step]) -> str:
    """Return the stages as SVG, from left to right.

    Raises:
        KeyError: when a stage has no place in the picture.
    """
    columns, rows = (1 + max(place[axis] for place in PLACES.values()) for axis in (0, 1))
    width, height = 2 * _LEFT + (columns - 1) * _COLUMN + _WIDTH, _TOP + rows * _ROW + 14
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}">',
        f"<style>{_STYLE}</style>",
        '<defs><marker id="h" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" orient="auto">'
        '<path d="M0 0L8 4L0 8z" style="fill:#555;stroke:none"/></marker></defs>',
        f'<rect width="{width}" height="{height}" fill="#fff"/>',
        *(_panel(name, height) for name in GROUPS),
        *(_arrow(source, target) for source, target in arrows(pipeline)),
        *(_box(step.name) for step in pipeline),
        f'<text class="a" x="{_LEFT}" y="{height - 8}">{_NOTE}</text>',
    ]
    return "\n".join([*parts, "</svg>"]) + "\n"


def _corner(name: str) -> tuple[int, int]:
    column, row, _ = PLACES[name]
    return _LEFT + column * _COLUMN, _TOP + row * _ROW


def _panel(name: str, height: int) -> str:
    first, last = GROUPS[name]
    left, right = _LEFT + first * _COLUMN - 8, _LEFT + last * _COLUMN + _WIDTH + 8
    return (
        f'<rect x="{left}" y="8" width="{right - left}" height="{height - 34}" rx="8" fill="{_COLOURS[name]}"/>'
        f'<text class="g" x="{(left + right) // 2}" y="28" text-anchor="middle">{name}</text>'
    )


def _box(name: str) -> str:
    (x, y), middle = _corner(name), _WIDTH // 2
    return (
        f'<rect x="{x}" y="{y}" width="{_WIDTH}" height="{_HEIGHT}" rx="5" fill="#fff" stroke="#888"/>'
        f'<text class="n" x="{x + middle}" y="{y + 19}" text-anchor="middle">{name}</text>'
        f'<text class="a" x="{x + middle}" y="{y + 36}" text-anchor="middle">{PLACES[name][2]}</text>'
    )


def _arrow(source: str, target: str) -> str:
    """Return a line of horizontal and vertical parts between two boxes."""
    (x, y), (to_x, to_y) = _corner(source), _corner(target)
    level, to_level = y + _HEIGHT // 2, to_y + _HEIGHT // 2
    right, apart = x + _WIDTH, PLACES[target][0] - PLACES[source][0]
    if apart == 0:
        line = f"M{x + _WIDTH // 2} {y + _HEIGHT}V{to_y}"
    elif level == to_level:
        line = f"M{right} {level}H{to_x}"
    elif apart == 1:
        line = f"M{right} {level}H{right + (_COLUMN - _WIDTH) // 2}V{to_level}H{to_x}"
    else:  # below the boxes in between, and up from there
        line = f"M{right} {level}H{to_x + _WIDTH // (apart + 1)}V{to_y + _HEIGHT}"
    return f'<path d="{line}" marker-end="url(#h)"/>'


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(picture(steps(ROOT)), encoding="utf-8")
