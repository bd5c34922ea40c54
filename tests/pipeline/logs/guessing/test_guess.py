"""The proposals for logs of no known layout: what is proposed confidently is right."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from simgap.logs.guess import guess
from simgap.logs.log import Log
from simgap.logs.proposal import SURE, Proposal
from simgap.logs.tabular import log_of_table
from simgap.recordings.units import conversion
from tests.pipeline.logs.guessing.naming import Made, make

LOGS = 150  # half a minute of one core would be 2000
OPTIONAL = ("battery_voltage",)


def proposed(frame: pd.DataFrame, kind: str | None = None) -> Proposal:
    return guess(log_of_table(frame, Path("log.csv"), "table"), kind)


def test_what_is_proposed_confidently_is_right() -> None:
    sure, right, whole = 0, 0, 0
    wrong = []
    for seed in range(LOGS):
        made = make(np.random.default_rng(seed))
        proposal = proposed(made.frame)
        for column, found in proposal.columns.items():
            if found.confidence >= SURE:
                sure += 1
                if is_right(made, proposal, column):
                    right += 1
                else:
                    wrong.append((seed, column, found, made.columns.get(column)))
        whole += proposal.is_sure
    print(f"{LOGS} logs: {sure} columns at {SURE} or more, {right} of them right; {whole} logs need no mapping file")
    assert right >= 0.99 * sure, wrong[:3]
    assert sure >= 2.5 * LOGS  # of three to four that there are
    assert whole >= 0.4 * LOGS  # where units are said or the derivative shows them


def is_right(made: Made, proposal: Proposal, column: str) -> bool:
    if column not in made.columns:
        return False
    name, factor = made.columns[column]
    source = proposal.columns[column].source
    found = conversion(source.unit or "1")
    return source.signal == name and found is not None and source.sign * source.scale * found[1] == pytest.approx(factor)
