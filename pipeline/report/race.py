"""The line that a quadrotor flew through its gates, coloured by speed."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_AXES = ("x", "y", "z")
_PICTURES = 10  # a second
_DOTS = 64  # per inch: with fifteen seconds on it, a page stays under 1.5 MB
_LONGEST = 15.0  # s that are shown
_TRAIL = 1.0  # s of the line that stay behind the machine


def race_figure(flight: pd.DataFrame, gates: NDArray[np.float32]) -> "Figure":
    """Draw a flight in three dimensions.

    Args:
        flight: with the columns `position_*` and `velocity_*` of a recording.
        gates: corners of the openings, (gates, 4, 3) m.
    """
    from matplotlib.figure import Figure
    from mpl_toolkits.mplot3d.art3d import Line3DCollection

    figure = Figure(figsize=(9.0, 6.5), layout="constrained")
    line, speed = _flown(flight)
    axes = _course(figure, line, gates)
    pieces = Line3DCollection(np.stack([line[:-1], line[1:]], axis=1), cmap="viridis", linewidth=2.0)
    pieces.set_array(speed[:-1])
    axes.add_collection3d(pieces)
    figure.colorbar(pieces, ax=axes, label="speed, m/s", shrink=0.7)
    return figure


def animate_race(flight: pd.DataFrame, gates: NDArray[np.float32], path: Path) -> None:
    """Write a flight as a short animation, a GIF in the time that it took.

    Args:
        flight: with the columns `t`, `position_*` and `velocity_*` of a recording.
        gates: corners of the openings, (gates, 4, 3) m.
        path: of the file.
    """
    from matplotlib.animation import FuncAnimation, PillowWriter
    from matplotlib.figure import Figure

    figure = Figure(figsize=(5.0, 3.8), layout="constrained")
    line, speed = _flown(flight)
    time = flight["t"].to_numpy(copy=True)
    axes = _course(figure, line, gates)
    (behind,) = axes.plot([], [], [], color="tab:blue", linewidth=1.5)
    (machine,) = axes.plot([], [], [], "o", color="tab:red")
    shown = np.searchsorted(time, np.arange(time[0], min(time[-1], time[0] + _LONGEST), 1.0 / _PICTURES))

    def draw(place: Any) -> tuple[Any, ...]:
        trail = line[np.searchsorted(time, time[place] - _TRAIL) : place + 1]
        behind.set_data_3d(*trail.T)
        machine.set_data_3d(*line[place : place + 1].T)
        axes.set_title(f"{time[place] - time[0]:.1f} s, {speed[place]:.1f} m/s")
        return behind, machine

    FuncAnimation(figure, draw, list(shown), interval=1000 // _PICTURES).save(
        path, PillowWriter(_PICTURES), dpi=_DOTS
    )


def _flown(flight: pd.DataFrame) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return the line (samples, 3), m, and the speed along it (samples,), m/s."""
    line = flight[[f"position_{axis}" for axis in _AXES]].to_numpy(copy=True)
    velocity = flight[[f"velocity_{axis}" for axis in _AXES]].to_numpy(copy=True)
    return line, np.linalg.norm(velocity, axis=1)


def _course(figure: "Figure", line: NDArray[Any], gates: NDArray[np.float32]) -> Any:
    """Return axes with the gates, numbered."""
    axes: Any = figure.add_subplot(projection="3d")
    for number, corners in enumerate(gates, 1):
        axes.plot(*np.vstack([corners, corners[:1]]).T, color="0.25", linewidth=2.5)
        axes.text(*corners[:2].mean(axis=0), str(number), ha="center", va="bottom")
    _frame(axes, np.vstack([line, gates.reshape(-1, 3)]))
    return axes


def _frame(axes: Any, points: NDArray[Any]) -> None:
    low, high = points.min(axis=0), points.max(axis=0)
    axes.set(xlabel="x, m", ylabel="y, m", zlabel="z, m")
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(min(low[2], 0.0), high[2]))
    axes.set_box_aspect(np.maximum(high - low, 1.0))
