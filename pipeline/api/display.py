"""An answer in a terminal or a notebook: the sentences of the page that `Answer.report` writes."""

from html import escape
from typing import Any

from simgap.report.terminal import terminal_lines
from simgap.report.verdict import Named, summary


def text(diagnosis: dict[str, Any]) -> str:
    """Return a diagnosis (docs/contract.md) as lines, as `simgap diagnose` prints it."""
    said = diagnosis["warnings"]
    warnings = [f"warnings: {len(said)}"] if said else []
    return "\n".join([*terminal_lines(diagnosis), *warnings])


def html(diagnosis: dict[str, Any]) -> str:
    """Return a diagnosis as a headline, a table of effects and notes; text from the recording is escaped."""
    said = summary(diagnosis)
    rows = [*map(_row, said.believed), *(_row(effect, "perhaps ") for effect in said.perhaps)]
    head = "".join(f"<th>{name}</th>" for name in ("effect", "values and probability", "meaning"))
    table = f"<table><thead><tr>{head}</tr></thead><tbody>{''.join(rows)}</tbody></table>" if rows else ""
    notes = [
        *said.contradictions,
        *(f"Not told apart: {rivals}" for rivals in said.ambiguous),
        *(f"Without a name: {rest}" for rest in said.unnamed),
        *diagnosis["warnings"],
    ]
    listed = f"<ul>{''.join(f'<li>{escape(note)}</li>' for note in notes)}</ul>" if notes else ""
    return f"<div><p><b>{escape(said.headline)}</b> {escape(said.closed)}</p>{table}{listed}</div>"


def _row(effect: Named, before: str = "") -> str:
    texts = (f"{before}{effect.words}", effect.facts, effect.statement)
    cells = (f'<td style="text-align:left">{escape(text)}</td>' for text in texts)
    return f"<tr>{''.join(cells)}</tr>"
