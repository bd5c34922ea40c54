"""Velocity, position and voltage over time."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from simgap.policies.profile.motion import Motion
from simgap.policies.profile.reference import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_SIZE = (7.5, 8.5)  # inches
_FAINT = 0.7


def draw_motions(
    motions: Mapping[str, Motion],
    target: float,
    path: Path,
    driven: Sequence[tuple[Array, Array, Array]] = (),
) -> None:
    """Draw motions as SVG, one under the other: velocity, position, and the mean voltage of the wheels.

    Args:
        motions: by name.
        target: of the position, m.
        path: of the picture.
        driven: time, s, position, m, and velocity, m/s, of trials on a machine, drawn faintly behind.
    """
    import matplotlib
    from matplotlib.figure import Figure

    with matplotlib.rc_context({"svg.hashsalt": path.stem, "svg.fonttype": "none"}):
        figure = Figure(figsize=_SIZE, layout="constrained")
        velocity, position, voltage = figure.subplots(3, 1, sharex=True)
        for number, (time, place, speed) in enumerate(driven):
            label = "trials on the machine" if number == 0 else None
            velocity.plot(time, speed, color="0.5", linewidth=_FAINT, label=label)
            position.plot(time, place, color="0.5", linewidth=_FAINT)
        for name, motion in motions.items():
            velocity.plot(motion.time, motion.velocity, label=name)
            position.plot(motion.time, motion.position)
            voltage.step(motion.time[:-1], motion.voltage.mean(axis=1), where="post")
        position.axhline(target, color="0.4", linestyle=":")
        _name(velocity, "velocity (m/s)")
        _name(position, "position (m)")
        _name(voltage, "voltage (V)")
        voltage.set_xlabel("time (s)")
        velocity.legend(frameon=False, fontsize="small")
        figure.savefig(path, format="svg", metadata={"Date": None})


def _name(axes: "Axes", label: str) -> None:
    axes.set_ylabel(label)
    axes.grid(alpha=0.3)
