"""An answer as a person reads it in a terminal or a notebook; all of it is in the page that `Answer.report` writes."""

from html import escape
from typing import TYPE_CHECKING

from simgap.report.text import estimate, interval, percent, probability, spoken

if TYPE_CHECKING:
    from simgap.api.answer import Answer
    from simgap.api.findings import Effect

_BELIEVED = 0.5  # a probability below which an effect is doubted


def text(answer: "Answer") -> str:
    """Return an answer in a few lines."""
    lines = [f"verdict: {answer.verdict}"]
    lines += [f"  {entry.evidence}. {entry.remedy}" for entry in answer.contradictions]
    lines += [
        f"  {_named(effect)}  {probability(effect.probability)}  {_values(effect)}"
        for effect in answer.effects
    ]
    lines += [f"  not told apart: {', '.join(rivals.names)}" for rivals in answer.ambiguous]
    lines += [f"  no name for {percent(entry.share)} of {entry.channel}" for entry in answer.unnamed]
    lines.append(f"  gap closed: {_closed(answer)}")
    if answer.warnings:
        lines.append(f"  warnings: {len(answer.warnings)}")
    return "\n".join(lines)


def html(answer: "Answer") -> str:
    """Return an answer as a table; text from the recording is escaped."""
    head = "".join(f"<th>{name}</th>" for name in ("effect", "probability", "values", "meaning"))
    rows = "".join(
        "<tr>"
        + "".join(f'<td style="text-align:left">{escape(cell)}</td>' for cell in _cells(effect))
        + "</tr>"
        for effect in answer.effects
    )
    notes = [
        *(f"{entry.evidence}. {entry.remedy}" for entry in answer.contradictions),
        *(f"Not told apart: {', '.join(rivals.names)}. {rivals.separate_by}" for rivals in answer.ambiguous),
        *(
            f"No name for {percent(entry.share)} of {entry.channel}: {entry.formula}"
            for entry in answer.unnamed
        ),
        *answer.warnings,
    ]
    listed = "".join(f"<li>{escape(note)}</li>" for note in notes)
    return (
        f"<div><p><b>{escape(spoken(answer.verdict).capitalize())}</b>. Gap closed: {escape(_closed(answer))}.</p>"
        + (f"<table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>" if rows else "")
        + (f"<ul>{listed}</ul>" if listed else "")
        + "</div>"
    )


def _cells(effect: "Effect") -> tuple[str, ...]:
    return _named(effect), probability(effect.probability), _values(effect), effect.statement


def _named(effect: "Effect") -> str:
    return effect.name if effect.probability >= _BELIEVED else f"perhaps {effect.name}"


def _values(effect: "Effect") -> str:
    return ", ".join(
        f"{name} {estimate(entry.value, entry.std, entry.unit)}" for name, entry in effect.parameters.items()
    )


def _closed(answer: "Answer") -> str:
    """Return the share of the gap that closed on held-out runs."""
    fit = answer.fit
    if fit.gap_closed is None:
        return "unknown, no run was held out"
    return f"{percent(fit.gap_closed)} on held-out runs ({interval(fit.gap_closed_interval)})"
