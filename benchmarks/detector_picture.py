"""Images of a camera with the corners that a detector found in them."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from benchmarks.detector import Shot

COLUMNS, ROWS = 4, 2
COLOURS = ("#d62728", "#2ca02c", "#1f77b4", "#ffbf00")  # left up, right up, right down, left down


def draw(shots: "Sequence[Shot]", path: Path) -> None:
    """Draw the first images of a flight, side by side."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(ROWS, COLUMNS, figsize=(10.0, 5.0), layout="constrained")
    for axis, shot in zip(axes.flat, shots, strict=False):
        axis.imshow(shot.image, cmap="gray", vmin=0.0, vmax=1.0)
        for gate in shot.found:
            axis.plot(*np.vstack((gate, gate[:1])).T, color="white", linewidth=0.6)
            axis.scatter(*gate.T, c=COLOURS, s=5)
        axis.set_axis_off()
    figure.savefig(path, dpi=100)
    plt.close(figure)
