"""Which seeds of the benchmark were used for what, and what its earlier runs scored: `seeds.csv` as a section."""

from collections.abc import Sequence
from pathlib import Path

import pandas as pd

TABLE = Path(__file__).with_name("seeds.csv")
HEADING = "## Seeds"
_SEEN = ["seeds", "use", "kinds", "cases", "remark"]


def read_seeds(path: Path = TABLE) -> pd.DataFrame:
    """Return one row for each use of a seed, or of several, as text; an empty text is unknown, or was not counted."""
    return pd.read_csv(path, dtype=str, keep_default_na=False)


def seeds_text(seeds: pd.DataFrame) -> str:
    """Return the section of the page: what was developed on which seeds, and what earlier runs scored."""
    scored = seeds["use"] == "scored"
    return "\n\n".join(
        [
            HEADING,
            "The engine was developed on some seeds, and its probabilities were fitted on others. "
            "A score on such a seed is no evidence for a new machine.",
            _table(seeds.loc[~scored, _SEEN]),
            "Each earlier run was scored once, with the engine of its time. "
            "The counts are effects named first, effects of pairs found, nulls in which something was named, "
            "and for the other categories answers that were right. "
            "*Outside* is the greatest probability of a wrong name outside the catalogue. "
            "*By chance* is the calibration error that chance leaves.",
            _table(seeds[scored].drop(columns="use")),
        ]
    )


def markdown_table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a table in Markdown."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def _table(rows: pd.DataFrame) -> str:
    return markdown_table(list(rows.columns), rows.to_numpy().tolist())
