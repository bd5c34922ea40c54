"""What an on-board estimate got wrong over a flight, and what is drawn in its place."""

from pathlib import Path

import pandas as pd
import torch

from simgap.policies.residual.beliefs import RESIDUALS, recorded_beliefs
from simgap.policies.residual.realisations import Realisations

_SIZE = (10.0, 7.0)  # inches
_UNITS = {"position": "m", "velocity": "m/s", "tilt": "rad"}


def draw_realisations(frame: pd.DataFrame, drawn: Realisations, path: Path, seconds: float = 10.0) -> None:
    """Draw the nine residuals along the first flight of a recording, recorded and as they are drawn.

    Args:
        frame: of a recording with `estimate_*` columns.
        drawn: functions of the state.
        path: of the picture.
        seconds: of the flight that are shown.
    """
    from matplotlib.figure import Figure

    flight = frame[frame["run"] == frame["run"].iloc[0]]
    flight = flight[flight["t"] < flight["t"].iloc[0] + seconds]
    features, residual, course = recorded_beliefs(flight, len(flight))
    times, count = course.moment, len(drawn)
    every = torch.arange(count).repeat_interleave(len(features))
    along = drawn(features.float().repeat(count, 1), times.float().repeat(count), every)
    along = along.unflatten(0, (count, -1))
    figure = Figure(figsize=_SIZE, layout="constrained")
    for place, (axes, name) in enumerate(
        zip(figure.subplots(3, 3, sharex=True).flat, RESIDUALS, strict=True)
    ):
        axes.plot(times, along[:, :, place].T.numpy(), color="tab:blue", alpha=0.1, linewidth=0.7)
        axes.plot(times, residual[:, place].numpy(), color="black", linewidth=1.0)
        axes.set_title(f"{name.replace('_', ' ')} ({_UNITS[name.split('_')[0]]})", fontsize="small")
        axes.grid(alpha=0.3)
    figure.supxlabel("time (s)")
    figure.suptitle(
        f"what the estimate got wrong: recorded (black), {len(drawn)} draws (blue)", fontsize="medium"
    )
    figure.savefig(path, dpi=100)
