"""How a policy flew: its laps, its line through the gates, and the flight itself."""

import base64
from collections.abc import Callable
from pathlib import Path
from typing import Any

from pipeline.report.inputs import ReportInputs, read_json
from pipeline.report.section import Drawing, Section
from pipeline.report.tables import Table
from pipeline.report.text import number, percent

_SAID: dict[str, tuple[str, Callable[[Any], str]]] = {
    "laps_completed": ("laps that were completed", percent),
    "completed": ("share of the gates that were passed", percent),
    "fastest_lap": ("fastest lap, s", number),
    "mean_lap": ("mean lap, s", number),
    "mean_margin": ("mean distance to the edge of a gate, m", number),
    "least_margin": ("least, m", number),
}


def flown_section(inputs: ReportInputs, drawing: Drawing) -> Section | None:
    """Show the race that was flown, if there was one."""
    metrics = read_json(inputs.evaluate, "metrics.json")
    if not metrics or inputs.evaluate is None:
        return None
    rows = [[said, write(metrics[name])] for name, (said, write) in _SAID.items() if name in metrics]
    pictures = [
        (f"image/{path.suffix[1:]}", _encoded(path))
        for path in (inputs.evaluate / "line.png", inputs.evaluate / "flight.gif")
        if path.exists()
    ]
    return Section("flown", "Race", {"table": Table("", ["", ""], rows), "pictures": pictures})


def _encoded(path: Path) -> str:
    return base64.b64encode(path.read_bytes()).decode("ascii")
