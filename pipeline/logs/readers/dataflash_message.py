"""The records of one type in a DataFlash log."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Message:
    """The records of one type.

    Attributes:
        name: as ATT.
        rows: one structured value a record, (n,).
        scales: of the fields that are stored as multiples.
        starts: places in the file, (n,).
    """

    name: str
    rows: NDArray[Any]
    scales: dict[str, float]
    starts: NDArray[np.int64]
