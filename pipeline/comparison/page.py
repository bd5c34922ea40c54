"""Comparisons in Markdown: tables, failed jobs, and sections of `docs/results.md`."""

import math
import re
import shutil
from pathlib import Path

from simgap.comparison.comparison import Comparison
from simgap.comparison.figure import FIGURE
from simgap.comparison.table import UNSWEPT, Row, Table, tables_of

PAGE = "results.md"
IMAGES = "images"

UNKNOWN = "–"

_HEAD = """# Results

`simgap results` writes each section from a sweep. The command in a section runs its sweep again. All scores are from
held-out runs. With several seeds a table shows the mean ± the standard deviation.
"""
_MARK = "<!-- sweep: {} -->"
_SECTION = re.compile(r"^<!-- sweep: (\S+) -->$", re.MULTILINE)

_WHOLE = 1e4  # from here on, a number has no decimals


def tables_text(comparison: Comparison) -> str:
    """Return all tables of a comparison and the reasons for failed jobs."""
    parts = []
    for table in tables_of(comparison):
        parts += [f"**{table.title}**"] if table.title else []
        parts.append(_markdown(table))
    parts += [f"Left out: {reason}" for reason in comparison.failed]
    return "\n\n".join(parts) + "\n"


def write_section(sweep: Path, docs: Path) -> None:
    """Write the section of one sweep into `results.md`, and its figure, if any. The other sections stay.

    Args:
        sweep: folder of the comparison.
        docs: folder of the documentation.

    Raises:
        InputError: when there is no comparison.
    """
    comparison = Comparison.read(sweep)
    figure = sweep / FIGURE
    picture = f"{IMAGES}/results_{comparison.name}{figure.suffix}"
    if figure.exists():
        (docs / IMAGES).mkdir(parents=True, exist_ok=True)
        shutil.copyfile(figure, docs / picture)
    else:
        (docs / picture).unlink(missing_ok=True)
    page = docs / PAGE
    sections = _sections(page.read_text(encoding="utf-8")) if page.exists() else {}
    sections[comparison.name] = _section(comparison, picture if figure.exists() else None)
    parts = [f"{_MARK.format(name)}\n{text}\n" for name, text in sections.items()]
    page.write_text("\n".join([_HEAD, *parts]), encoding="utf-8")


def _sections(page: str) -> dict[str, str]:
    _, *rest = _SECTION.split(page)
    return {name: text.strip() for name, text in zip(rest[::2], rest[1::2], strict=True)}


def _section(comparison: Comparison, picture: str | None) -> str:
    title = comparison.results.title or comparison.name
    seeds = sorted({job.seed for job in comparison.jobs})
    minutes = sum(job.seconds for job in comparison.jobs) / 60
    facts = (
        f"`{comparison.command}`\n\nMeasured on {comparison.machine}. The {len(comparison.jobs)} jobs took "
        f"{minutes:.1f} minutes in sequence (seed{'s' if len(seeds) > 1 else ''} {', '.join(map(str, seeds))})."
    )
    parts = [f"## {title}", *filter(None, [comparison.results.text]), facts, tables_text(comparison).strip()]
    return "\n\n".join([*parts, *([f"![{title}]({picture})"] if picture else [])])


def _markdown(table: Table) -> str:
    keys = table.keys or [""]
    heads = [table.named.get(key, key) for key in keys]
    lines = [[*heads, *table.columns], [*["---"] * len(keys), *["--:"] * len(table.columns)]]
    for row in table.rows:
        first = (
            [row.reference] + [""] * (len(keys) - 1) if row.reference else [_value(row, key) for key in keys]
        )
        lines.append([*first, *(_cell(table, row, column) for column in table.columns)])
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def _value(row: Row, key: str) -> str:
    return str(row.values.get(key, "")).replace("|", "\\|") if row.values else UNSWEPT


def _cell(table: Table, row: Row, column: str) -> str:
    estimate, change = row.entries[column], table.change(row, column)
    text = _number(estimate.mean)
    text += f" ± {estimate.std:.2g}" if estimate.std is not None and text != UNKNOWN else ""
    return text if change is None else f"{text} ({change:+.0%})"


def _number(value: float) -> str:
    if not math.isfinite(value):
        return UNKNOWN
    return f"{value:,.0f}" if abs(value) >= _WHOLE else f"{value:.4g}"
