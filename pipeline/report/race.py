"""The line that a quadrotor flew through its gates, coloured by speed."""

from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_AXES = ("x", "y", "z")


def race_figure(flight: pd.DataFrame, gates: NDArray[np.float32]) -> "Figure":
    """Draw a flight in three dimensions.

    Args:
        flight: with the columns `position_*` and `velocity_*` of a recording.
        gates: corners of the openings, (gates, 4, 3) m.
    """
    from matplotlib.figure import Figure
    from mpl_toolkits.mplot3d.art3d import Line3DCollection

    figure = Figure(figsize=(9.0, 6.5), layout="constrained")
    axes = figure.add_subplot(projection="3d")
    line = flight[[f"position_{axis}" for axis in _AXES]].to_numpy(copy=True)
    speed = np.linalg.norm(flight[[f"velocity_{axis}" for axis in _AXES]].to_numpy(copy=True), axis=1)
    pieces = Line3DCollection(np.stack([line[:-1], line[1:]], axis=1), cmap="viridis", linewidth=2.0)
    pieces.set_array(speed[:-1])
    axes.add_collection3d(pieces)
    for number, corners in enumerate(gates, 1):
        axes.plot(*np.vstack([corners, corners[:1]]).T, color="0.25", linewidth=2.5)
        axes.text(*corners[:2].mean(axis=0), str(number), ha="center", va="bottom")
    _frame(axes, np.vstack([line, gates.reshape(-1, 3)]))
    figure.colorbar(pieces, ax=axes, label="speed, m/s", shrink=0.7)
    return figure


def _frame(axes: Any, points: NDArray[np.float32]) -> None:
    low, high = points.min(axis=0), points.max(axis=0)
    axes.set(xlabel="x, m", ylabel="y, m", zlabel="z, m")
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(min(low[2], 0.0), high[2]))
    axes.set_box_aspect(np.maximum(high - low, 1.0))
