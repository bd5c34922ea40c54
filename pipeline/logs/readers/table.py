"""Tables: Parquet, and CSV as people export it."""

from pathlib import Path

import numpy as np
import pandas as pd

from simgap.logs.log import Log, Signal
from simgap.recordings.storage import read_table


def read(path: Path) -> Log:
    """Read a table; the clock of its signals is the row number.

    Raises:
        InputError: when the file is damaged, or no table.
    """
    table = read_table(path)
    signals, texts = {}, {}
    for name, column in table.frame.items():
        if pd.api.types.is_numeric_dtype(column.dtype):
            values = column.to_numpy(dtype="float64", na_value=np.nan)
            rows = np.arange(len(values), dtype="float64")
            signals[str(name)] = Signal(str(name), rows, values, table.units.get(str(name)))
        else:
            texts[str(name)] = column.to_numpy(dtype=object)
    return Log("table", str(path), signals, remarks=table.remarks, texts=texts, tabular=True)
