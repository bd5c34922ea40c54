"""How a policy flew: laps in the simulator and on the machine, the line through the gates, and the flight itself."""

import base64
from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from typing import Any

from simgap.report.inputs import ReportInputs, read_json
from simgap.report.section import Drawing, Section
from simgap.report.tables import Table
from simgap.report.text import number, percent

_COLOURS = 96
_SAID: dict[str, tuple[str, Callable[[Any], str]]] = {
    "laps_completed": ("laps that were completed", percent),
    "completed": ("share of the gates that were passed", percent),
    "fastest_lap": ("fastest lap, s", number),
    "mean_lap": ("mean lap, s", number),
    "mean_margin": ("mean distance to the edge of a gate, m", number),
    "least_margin": ("least, m", number),
}
_KNEW: dict[str, tuple[str, Callable[[Any], str]]] = {  # of where the machines were, where it was measured
    "position_error": ("error of the estimated position, RMS, m", number),
    "gate_in_view": ("share of the time with a gate in view", percent),
    "images": ("images that a gate detector read", number),
    "gates_found": ("gates that it found", number),
    "gates_believed": ("of them, taken for gates of the track", number),
}


def flown_section(inputs: ReportInputs, drawing: Drawing) -> Section | None:
    """Show the races that were flown, if there were any."""
    folders = {
        "in the simulator": inputs.evaluate,
        "on the machine": inputs.deploy,
        "trained further, on the machine": inputs.redeploy,
    }
    races = {where: read_json(folder, "metrics.json") for where, folder in folders.items()}
    races = {where: metrics for where, metrics in races.items() if metrics and "laps_completed" in metrics}
    if not races:
        return None
    measured = {name for metrics in races.values() for name in metrics}
    shown = _SAID | {name: said for name, said in _KNEW.items() if name in measured}
    rows = [
        [said, *(write(metrics[name]) if name in metrics else "–" for metrics in races.values())]
        for name, (said, write) in shown.items()
    ]
    content = {
        "table": Table("", ["", *races], rows),
        "pictures": _pictures(inputs.evaluate, "line.png", "flight.gif"),
        "misjudged": _pictures(inputs.identify_residual, "realisations.png"),
    }
    return Section("flown", "Race", content)


def _pictures(folder: Path | None, *names: str) -> list[tuple[str, str]]:
    """Return kind and content of the pictures that are there."""
    paths = [folder / name for name in names] if folder is not None else []
    return [(f"image/{path.suffix[1:]}", _encoded(path)) for path in paths if path.exists()]


def _encoded(path: Path) -> str:
    """Return a picture as text; a drawing in few colours takes a third of the room."""
    if path.suffix != ".png":
        return base64.b64encode(path.read_bytes()).decode("ascii")
    from PIL import Image

    small = BytesIO()
    with Image.open(path) as picture:
        picture.convert("RGB").quantize(_COLOURS).save(small, "PNG", optimize=True)
    return base64.b64encode(small.getvalue()).decode("ascii")
