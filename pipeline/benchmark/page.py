"""The results of the benchmark as a Markdown page (`docs/proof.md`)."""

import math
import platform as machine
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from simgap.artifacts import PROJECT_ROOT
from simgap.benchmark import measures
from simgap.benchmark.intervals import Share, quantile, share_of
from simgap.benchmark.published import published_rows
from simgap.benchmark.reliability import reliability_figure
from simgap.benchmark.seeds import HEADING as SEEDS
from simgap.benchmark.seeds import markdown_table, read_seeds, seeds_text

DOCS = PROJECT_ROOT / "docs"
FIGURE = "images/reliability.svg"
RESULTS = "## Results"
"""Heading of the measured part of the page."""

_INTRODUCTION = Path(__file__).with_name("introduction.md")
_WORST = 25  # wrong first names that are listed


def results_text(results: Sequence[measures.Result], command: str) -> str:
    """Return the results as Markdown.

    Args:
        results: of all cases.
        command: the command that produced them.
    """
    parts = [f"`{command}` on {_processor()}."]
    concealed = [result for result in results if "case" in result]
    published = [result for result in results if "branch" in result]
    if concealed:
        parts += _concealed(concealed)
    if published:
        head = [
            "recording",
            "known",
            "named",
            "gap closed",
            "error explained by names, by a regression",
            "removed and named first again",
            "seconds",
        ]
        parts += [
            "Published recordings with known effects:",
            markdown_table(["measured", "bar", ""], _bar_rows(measures.PUBLISHED_BARS, published)),
            markdown_table(head, published_rows(published)),
        ]
    return "\n\n".join(parts) + "\n"


def _concealed(results: Sequence[measures.Result]) -> list[str]:
    drawn, results = len(results), [result for result in results if measures.is_case(result)]
    kinds = list(dict.fromkeys(result["case"]["kind"] for result in results))
    return [
        f"{len(results)} concealed cases. {drawn - len(results)} more were drawn, but no realistic effect size reaches "
        "what their category demands.",
        markdown_table(["measured", "bar", "", *kinds], _bar_rows(measures.BARS, results, kinds)),
        markdown_table(["also", "", *kinds], _other_rows(results, kinds)),
        "Per effect: how often it is named first, median error of its first parameter, median of the gap closed.",
        markdown_table(["kind", "effect", "clear", "faint", "error", "gap closed"], _effect_rows(results)),
        "Wrong first names, most frequent first:",
        markdown_table(
            ["concealed", "named first", "cases"], [list(map(str, row)) for row in _worst(results)]
        ),
    ]


def write_docs(results: Sequence[measures.Result], command: str) -> None:
    """Write introduction, results and figure into the documentation."""
    stated = measures.stated([result for result in results if "case" in result])
    (DOCS / FIGURE).write_text(reliability_figure(stated), encoding="utf-8")
    figure = f"![Stated probabilities against the share that is there]({FIGURE})"
    _write_page(f"{results_text(results, command)}\n{figure}\n")


def renew_introduction() -> None:
    """Renew the introduction and the table of seeds in docs/proof.md; what was measured stays.

    Raises:
        ValueError: when the page has no results.
    """
    _, heading, results = (DOCS / "proof.md").read_text(encoding="utf-8").partition(f"\n{RESULTS}\n\n")
    if not heading:
        raise ValueError(f"{DOCS / 'proof.md'} has no heading {RESULTS!r}")
    _write_page(results)


def _write_page(results: str) -> None:
    introduction = _INTRODUCTION.read_text(encoding="utf-8")
    measured = results.partition(f"{SEEDS}\n")[0].rstrip()
    text = "\n\n".join([introduction.rstrip(), RESULTS, measured, seeds_text(read_seeds())])
    (DOCS / "proof.md").write_text(f"{text}\n", encoding="utf-8")


def _bar_rows(
    bars: Sequence[measures.Bar], results: Sequence[measures.Result], kinds: Sequence[str] = ()
) -> list[list[str]]:
    rows = []
    for bar in bars:
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
        [name, _text(value, False), *(_text(one.get(name, share_of(())), False) for one in each)]
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


if __name__ == "__main__":  # python -m simgap.benchmark.page
    renew_introduction()
