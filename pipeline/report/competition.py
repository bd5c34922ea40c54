"""How sure: the competition that the named effects won."""

from typing import Any

from simgap.report.figure import AFTER, FAINT, GRID, INK, Figure, axis, distances, encode, label, layout
from simgap.report.inputs import ReportInputs
from simgap.report.section import Drawing, Section
from simgap.report.text import is_number, percent, spoken

_DRAWN = 12  # candidates drawn per step; the table lists all


def competition_section(inputs: ReportInputs, drawing: Drawing) -> Section | None:
    """Show, step by step, which effects competed, what each would gain, and which was chosen."""
    competition = inputs.evidence("competition.json")
    if not competition or not competition.get("steps"):
        return None
    steps = [_step(entry) for entry in competition["steps"]]
    return Section(
        "competition",
        "How sure",
        {"steps": steps, "metric": competition.get("metric") or "", "shown": drawing.competition_steps},
    )


def _step(entry: dict[str, Any]) -> dict[str, Any]:
    candidates = sorted(
        entry.get("candidates") or [],
        key=lambda candidate: (
            not candidate.get("chosen"),
            -candidate["gain"] if is_number(candidate.get("gain")) else 1e300,
        ),
    )
    chosen = next((candidate["name"] for candidate in candidates if candidate.get("chosen")), None)
    drawn = [candidate for candidate in candidates if is_number(candidate.get("gain"))][:_DRAWN]
    figure = _figure(drawn) if drawn else None
    return {
        "step": entry["step"],
        "chosen": chosen,
        "outcome": spoken(chosen) if chosen else "nothing",
        "candidates": candidates,
        "figure": figure,
    }


def _figure(candidates: list[dict[str, Any]]) -> Figure:
    gains = [candidate["gain"] for candidate in candidates]
    lows, highs = ([candidate.get(key) for candidate in candidates] for key in ("gain_low", "gain_high"))
    colours = [AFTER if candidate.get("chosen") else FAINT for candidate in candidates]
    points = {
        "type": "scatter",
        "mode": "markers",
        "x": encode(gains),
        "y": list(range(len(candidates))),
        "error_x": distances(gains, lows, highs) | {"color": FAINT, "thickness": 1.5, "width": 4},
        "marker": {"color": colours, "size": 10},
        "hovertext": [_hover(candidate) for candidate in candidates],
        "hoverinfo": "text",
        "showlegend": False,
    }
    names = [label(spoken(candidate["name"])) for candidate in candidates]
    ticktext = [
        f"<b>{name}</b>" if candidate.get("chosen") else name
        for name, candidate in zip(names, candidates, strict=True)
    ]
    y = axis(
        "", tickvals=list(range(len(names))), ticktext=ticktext, range=[len(names) - 0.4, -0.6], ticks=""
    )
    x = axis("share of the remaining gap closed", tickformat=".2~%", zeroline=True, zerolinecolor=INK)
    drawn = layout(x, y | {"gridcolor": GRID, "zeroline": False}, margin={"l": 8, "r": 16, "t": 30, "b": 44})
    return Figure("", [points], drawn, 100 + 26 * len(candidates))


def _hover(candidate: dict[str, Any]) -> str:
    note = f"<br>{label(candidate['note'], 90)}" if candidate.get("note") else ""
    return f"{label(spoken(candidate['name']))}: {percent(candidate['gain'])}{note}"
