import xml.etree.ElementTree as ET

import pandas as pd

from simgap.recordings.cleaning import COVERAGE_COLUMNS
from simgap.recordings.cleaning.figure import coverage_figure

_SVG = "{http://www.w3.org/2000/svg}"


def test_a_bar_is_as_wide_as_its_time_and_names_are_escaped():
    rows = [
        ("<b>&", 0.0, 5.0, "kept", ""),
        ("<b>&", 5.0, 10.0, "dropped", "crash"),
        ("two", 100.0, 102.0, "kept", ""),
    ]
    root = ET.fromstring(coverage_figure(pd.DataFrame(rows, columns=list(COVERAGE_COLUMNS))))
    assert "<b>&" in [text.text for text in root.iter(f"{_SVG}text")]
    bars = [bar for bar in root.iter(f"{_SVG}rect") if bar.find(f"{_SVG}title") is not None]
    widths = [(bar.find(f"{_SVG}title").text, float(bar.get("width"))) for bar in bars]
    assert widths == [("kept", 450.0), ("dropped", 450.0), ("kept", 180.0)]
