"""The runs of a table that has the contract's names, but whose column of the run has another one."""

from dataclasses import replace
from pathlib import Path

from simgap.errors import InputError
from simgap.logs.guessing.runs import run_of
from simgap.logs.mapping import Source
from simgap.logs.proposal import SURE, Proposed
from simgap.logs.tabular import log_of_table
from simgap.recordings.contract import COLUMNS, INDEX_COLUMNS
from simgap.recordings.storage import Table

_KNOWN = {*INDEX_COLUMNS, *(column for columns in COLUMNS.values() for column in columns)} - {"t"}


def with_run(table: Table, path: Path) -> Table:
    """Return a table whose column of the run is called so, where another one says the runs for sure.

    Args:
        table: with the contract's names.
        path: of the file.

    Raises:
        InputError: when there is no such column, but one that may be it.
    """
    if "run" in table.frame or "t" not in table.frame or not len(table.frame):
        return table
    strange = [column for column in table.frame.columns if str(column) not in _KNOWN]
    found = run_of(log_of_table(table.frame[strange], path, "table"), Proposed(Source("t"), 1.0, ""))
    if found is None:
        return table
    name = found.source.signal
    if found.confidence < SURE:
        raise InputError(
            f"column 'run' is missing, and {name!r} may be it ({found.reason})",
            str(path),
            f"rename it, or give a mapping with run: {name}",
        )
    remark = f"Column {name!r} is taken as the run: {found.reason}."
    return replace(table, frame=table.frame.rename(columns={name: "run"}), remarks=(*table.remarks, remark))
