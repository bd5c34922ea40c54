"""What a benchmark showed, as a page that a person reads."""

import math
import platform as machine
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from simgap.artifacts import PROJECT_ROOT
from simgap.benchmark import measures
from simgap.benchmark.intervals import Share, quantile
from simgap.benchmark.published import published_rows
from simgap.benchmark.reliability import reliability_figure
from simgap.benchmark.seeds import markdown_table, read_seeds, seeds_text

DOCS = PROJECT_ROOT / "docs"
FIGURE = "images/reliability.svg"
_INTRODUCTION = Path(__file__).with_name("introduction.md")
_WORST = 25  # confusions that are listed


def results_text(results: Sequence[measures.Result], command: str) -> str:
    """Return the whole page as Markdown.

    Args:
        results: of all cases.
        command: that made them.
    """
    parts = [f"`{command}` on {_processor()}."]
    concealed = [result for result in results if "case" in result]
    published = [result for result in results if "branch" in result]
    if concealed:
        parts += _concealed(concealed)
    if published:
        head = ["recording", "known", "named", "gap closed", "taken out and found first again", "seconds"]
        parts += [
            "Published recordings, whose answer is known:",
            markdown_table(head, published_rows(published)),
        ]
    return "\n\n".join(parts) + "\n"


def _concealed(results: Sequence[measures.Result]) -> list[str]:
    drawn, results = len(results), [result for result in results if measures.is_case(result)]
    kinds = list(dict.fromkeys(result["case"]["kind"] for result in results))
    return [
        f"{len(results)} concealed cases; {drawn - len(results)} more were drawn in which no strength that a machine "
        "has shows as clearly, or as faintly, as the case wants.",
        markdown_table(["measured", "bar", "", *kinds], _bar_rows(results, kinds)),
        markdown_table(["also", "", *kinds], _other_rows(results, kinds)),
        "Every effect: how often it is named first, the median error of its strength, the median of the gap closed.",
        markdown_table(["kind", "effect", "clear", "faint", "error", "gap closed"], _effect_rows(results)),
        "What was taken for what, the most frequent first:",
        markdown_table(
            ["concealed", "named first", "cases"], [list(map(str, row)) for row in _worst(results)]
        ),
    ]


def write_docs(results: Sequence[measures.Result], command: str) -> None:
    """Write the page and its figure into the documentation."""
    stated = measures.stated([result for result in results if "case" in result])
    (DOCS / FIGURE).write_text(reliability_figure(stated), encoding="utf-8")
    figure = f"![Stated probabilities against the share that is there]({FIGURE})"
    parts = [_INTRODUCTION.read_text(encoding="utf-8"), results_text(results, command), figure]
    text = "\n".join([*parts, "", seeds_text(read_seeds())])
    (DOCS / "proof.md").write_text(f"{text}\n", encoding="utf-8")


def _bar_rows(results: Sequence[measures.Result], kinds: Sequence[str]) -> list[list[str]]:
    rows = []
    for bar in measures.BARS:
        value = bar.measured(results)
        met = {True: "met", False: "**not met**", None: "no cases"}[measures.is_met(bar, value)]
        sign = "≥" if bar.at_least else "≤"
        wanted = f"{sign} {bar.wanted:.0%}" if bar.percent else f"{sign} {bar.wanted:g}"
        each = [_text(bar.measured(_of_kind(results, kind)), bar.percent) for kind in kinds]
        rows.append([f"{bar.name}: {_text(value, bar.percent)}", wanted, met, *each])
    return rows


def _other_rows(results: Sequence[measures.Result], kinds: Sequence[str]) -> list[list[str]]:
    every = measures.overall(results)
    each = [measures.overall(_of_kind(results, kind)) for kind in kinds]
    rows = [
        [name, _text(value, False), *(_text(one[name], False) for one in each)]
        for name, value in every.items()
    ]
    closed = [measures.gaps_closed(_of_kind(results, kind)) for kind in kinds]
    quartiles = [_quartiles(values) for values in (measures.gaps_closed(results), *closed)]
    return [*rows, ["gap closed, quartiles", *quartiles]]


def _effect_rows(results: Sequence[measures.Result]) -> list[list[str]]:
    single = [
        r for r in results if len(r["case"]["subject"]["names"]) == 1 and measures.category(r) != "outside"
    ]
    names = sorted({(r["case"]["kind"], r["case"]["subject"]["names"][0]) for r in single})
    rows = []
    for kind, name in names:
        mine = [r for r in single if (r["case"]["kind"], r["case"]["subject"]["names"][0]) == (kind, name)]
        plain = measures.of(mine, "clear", "faint", "decoy")
        cells = [
            _count(measures.named_first([r for r in plain if measures.strength(r) == strength]))
            for strength in ("clear", "faint")
        ]
        error, closed = measures.parameter_error(mine), quantile(measures.gaps_closed(mine), 0.5)
        rows.append([kind, f"`{name}`", *cells, _text(error, True), _text(closed, True)])
    return rows


def _worst(results: Sequence[measures.Result]) -> list[tuple[str, str, int]]:
    return measures.confusions(results)[:_WORST]


def _of_kind(results: Sequence[measures.Result], kind: str) -> list[measures.Result]:
    return [result for result in results if result["case"]["kind"] == kind]


def _count(share: Share) -> str:
    return f"{share.count:g}/{share.total}" if share.total else "–"


def _quartiles(values: Sequence[float]) -> str:
    return " · ".join(_text(quantile(values, place), True) for place in (0.25, 0.5, 0.75))


def _text(value: Any, percent: bool) -> str:
    if isinstance(value, Share):
        return value.text
    if isinstance(value, int):
        return str(value)
    if math.isnan(value):
        return "–"
    return f"{value:.1%}" if percent else f"{value:.3g}"


def _processor() -> str:
    return f"{machine.system()} {machine.machine()}, Python {machine.python_version()}"
