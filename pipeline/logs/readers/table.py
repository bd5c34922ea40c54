"""Tables: Parquet, and CSV as people export it."""

from pathlib import Path

from simgap.logs.log import Log
from simgap.logs.tabular import log_of_table
from simgap.recordings.storage import read_table


def read(path: Path) -> Log:
    """Read a table; the clock of its signals is the row number.

    Raises:
        InputError: when the file is damaged, or no table.
    """
    table = read_table(path)
    return log_of_table(table.frame, path, "table", table.units, remarks=table.remarks)
