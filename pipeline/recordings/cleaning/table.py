"""The channels of a run under cleaning: each is the recording's own until it is changed."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd


@dataclass
class ChannelTable:
    """Channels by their places; one that is changed is copied before, and only then.

    Attributes:
        arrays: the channels, each (samples,).
        shared: the column of the recording that a channel still is; None where it is a copy.
    """

    arrays: list[np.ndarray]
    shared: list[pd.Series | None]

    @classmethod
    def of(cls, frame: pd.DataFrame, channels: Sequence[str]) -> "ChannelTable":
        """Return channels of a frame; what is not float64 in one piece of memory is copied."""
        table = cls.empty(len(channels))
        for place, column in enumerate(frame[channel] for channel in channels):
            values = column.to_numpy(dtype="float64")
            if column.dtype == np.float64 and values.flags.c_contiguous:
                table.arrays[place], table.shared[place] = values, column
            else:
                table.put(place, np.array(values))
        return table

    @classmethod
    def empty(cls, channels: int) -> "ChannelTable":
        """Return so many channels that are to be put in."""
        return cls([np.empty(0)] * channels, [None] * channels)

    def own(self, place: int) -> np.ndarray:
        """Return a channel, (samples,), to be written to."""
        if self.shared[place] is not None:
            self.put(place, self.arrays[place].copy())
        return self.arrays[place]

    def put(self, place: int, values: np.ndarray) -> None:
        """Let a channel be an array, (samples,), which is nobody else's."""
        self.arrays[place], self.shared[place] = values, None

    def kept(self, place: int, rows: slice | np.ndarray) -> pd.Series | np.ndarray:
        """Return some samples of a channel; of one that is still the recording's as a column that pandas knows of."""
        shared = self.shared[place]
        return self.arrays[place][rows] if shared is None else shared.iloc[rows].reset_index(drop=True)
