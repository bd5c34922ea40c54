"""Tables in the long form: each row is a time, the name of a signal, and a value."""

import numpy as np
import pandas as pd

from simgap.logs.header_units import unit_in
from simgap.logs.log import Signal

_TIME = ("time", "timestamp", "t", "stamp")
_KEY = ("key", "name", "topic", "signal", "channel", "entry", "field", "variable")
_VALUE = ("value", "data", "val")
_MOST = 5000  # different names; more are no names
_FLAGS = {"true": 1, "false": 0, "True": 1, "False": 0}


def long_signals(frame: pd.DataFrame) -> tuple[object, list[Signal]] | None:
    """Return the name of the column of time, and one signal for each name, at its rows; None for any other table.

    Args:
        frame: as it was read.
    """
    columns = {str(name).strip().lower().split(" ")[0]: name for name in frame.columns}
    found = [next((columns[n] for n in names if n in columns), None) for names in (_TIME, _KEY, _VALUE)]
    time, key, value = found
    if time is None or key is None or value is None or pd.api.types.is_numeric_dtype(frame[key].dtype):
        return None
    codes, names = pd.factorize(frame[key])
    if len(names) > _MOST:
        return None
    numbers = pd.to_numeric(frame[value].replace(_FLAGS), errors="coerce")
    values = numbers.to_numpy(dtype="float64", na_value=np.nan)
    order = np.argsort(codes, kind="stable")
    edges = np.searchsorted(codes[order], np.arange(len(names) + 1))
    signals = []
    for place, name in enumerate(names):
        rows = order[edges[place] : edges[place + 1]]
        rows = rows[np.isfinite(values[rows])]
        if len(rows):
            signals.append(Signal(str(name), rows.astype("float64"), values[rows], unit_in(str(name))))
    return (time, signals) if signals else None
