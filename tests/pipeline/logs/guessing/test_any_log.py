"""Whatever a table holds, a proposal is made of it, or it is refused in one line."""

import warnings
from pathlib import Path

import numpy as np
import pandas as pd
from hypothesis import given, settings
from hypothesis import strategies as st

from simgap.logs.guess import guess
from simgap.logs.proposal_file import proposal_text
from simgap.logs.tabular import log_of_table
from simgap.recordings.contract import KINDS, channel_units

NAMES = (
    "t", "time_ms", "run", "pos", "vel_rad_s", "torque", "u", "duty", "vbat", "qw", "qx", "qy", "qz", "wx", "wy", "wz",
    "px", "py", "pz", "vx", "vy", "vz", "ax", "ay", "az", "m1", "m2", "m3", "m4", "target", "FL drive volts (V)", "x",
)  # fmt: skip


def column(kind: int, rng: np.random.Generator, rows: int) -> object:
    """Return a column of one of the kinds that go wrong."""
    values = rng.standard_normal(rows)
    return [
        values, np.cumsum(np.abs(values)), np.full(rows, 7.0), np.full(rows, np.nan), 1e300 * values, values > 0,
        np.where(values > 1, np.inf, values), np.where(values > 0, np.nan, values), np.arange(rows),
        np.full(rows, "a", dtype=object),
    ][kind]  # fmt: skip


@settings(max_examples=25)
@given(
    kinds=st.dictionaries(st.sampled_from(NAMES), st.integers(0, 9), min_size=1, max_size=len(NAMES)),
    rows=st.sampled_from([1, 2, 3, 40, 90]),
    seed=st.integers(0, 9),
    kind=st.sampled_from([None, *KINDS]),
)
def test_any_table_gets_a_proposal(kinds: dict[str, int], rows: int, seed: int, kind: str | None) -> None:
    rng = np.random.default_rng(seed)
    frame = pd.DataFrame({name: column(number, rng, rows) for name, number in kinds.items()})
    log = log_of_table(frame, Path("log.csv"), "table")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # of absurd values, which are in none of the columns
        proposal = guess(log, kind)
    known = {"t", "run"} | {name for each in KINDS for name in channel_units(each)}
    assert set(proposal.columns) <= known
    assert all(found.source.signal in {*log.signals, *log.texts} for found in proposal.columns.values())
    assert all(0.0 <= found.confidence <= 1.0 for found in proposal.columns.values())
    assert "\n" not in proposal.refusal
    assert proposal_text(log, proposal).startswith("# Proposed for log.csv")
