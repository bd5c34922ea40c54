"""A lap through the eyes of a machine, as a moving picture: python -m benchmarks.flight_picture FOLDER FILE.webp

FOLDER is that of a detector (simgap train_detector). On the left is what the camera sees, with the gates it found.
On the right, from above, are the gates of the track and three lines: where the machine flies, where its odometry says,
and where it is after what was found in the images has been taken in.
"""

import argparse
from collections.abc import Iterator
from dataclasses import dataclass, replace
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from benchmarks.detector_picture import COLOURS
from benchmarks.perception import PERIOD, Array, flown, odometry_of, states_of
from simgap.api.inputs import settings_of
from simgap.gates.settings import TrackSettings
from simgap.gates.track import Track, track_from
from simgap.perception.chain import Chain
from simgap.perception.eye import Eye, Eyes
from simgap.perception.settings import PerceptionSettings
from simgap.perception.storage import load_detector
from simgap.runner.compose import compose

APART = 0.12  # s, from image to image: three times what a machine has in flight, to keep the file small
MISJUDGED = 0.3  # m/s, by which odometry misjudges velocity
QUALITY = 45  # of WebP, of 100
LINES = {"flown": "0.6", "odometry": "#d62728", "corrected": "#1f77b4"}


@dataclass(frozen=True)
class Instant:
    """An image, the gates that were found in it, and the three lines so far, (steps, 3) m each."""

    image: Array
    found: Array
    lines: dict[str, Array]


def instants(eye: Eye, track: Track, seed: int) -> Iterator[Instant]:
    """Yield what a machine sees and believes along a lap, image by image."""
    flight = flown(track, laps=1)
    truth = states_of(flight)
    odometry = states_of(odometry_of(flight, MISJUDGED, np.random.default_rng([seed, 1])))
    eyes = Eyes(eye, track, seed)
    seen: list[Array] = []

    def look(states: Array) -> list[Array]:
        seen[:] = eyes(states)
        return list(seen)

    chain, corrected = Chain(look, eye.settings, track, 1, PERIOD, seed), []
    for step in range(len(truth)):
        seen.clear()
        corrected.append(chain.corrected(truth[[step]], odometry[[step]])[0])
        if seen:
            lines = zip(LINES, (truth[: step + 1], odometry[: step + 1], np.stack(corrected)), strict=True)
            yield Instant(
                eyes.images[0, 0].cpu().numpy(), seen[0], {name: line[:, :3] for name, line in lines}
            )


def drawn(instant: Instant, track: Track) -> Image.Image:
    """Draw an instant."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.4, 3.2), layout="constrained")
    view, plan = figure.subplots(1, 2)
    view.imshow(instant.image, cmap="gray", vmin=0.0, vmax=1.0)
    for gate in instant.found:
        view.plot(*np.vstack((gate, gate[:1])).T, color="#ffbf00", linewidth=1.2)
        view.scatter(*gate.T, c=COLOURS, s=9, zorder=3)
    view.set_axis_off()
    _plan(plan, instant, track)
    file = BytesIO()
    figure.savefig(file, dpi=100)
    return Image.open(file).convert("RGB")


def _plan(axes: Any, instant: Instant, track: Track) -> None:
    for number, corners in enumerate(track.corners.numpy(), 1):
        axes.plot(*corners[:2, :2].T, color="black", linewidth=3.0)
        axes.annotate(str(number), corners[0, :2], textcoords="offset points", xytext=(4, 4))
    for name, colour in LINES.items():
        line = instant.lines[name]
        axes.plot(*line[:, :2].T, color=colour, linewidth=1.2, label=name)
        axes.plot(*line[-1, :2], "o", color=colour, markersize=4.0)
    low, high = track.centres.numpy().min(0), track.centres.numpy().max(0)
    axes.set(xlim=(low[0] - 6.0, high[0] + 6.0), ylim=(low[1] - 6.0, high[1] + 6.0), aspect="equal")
    axes.set(xlabel="x, m", ylabel="y, m")
    axes.legend(loc="lower right", fontsize=7)


def main() -> None:
    """Write the picture."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.flight_picture", description=__doc__)
    parser.add_argument("folder", type=Path, help="of a detector")
    parser.add_argument("file", type=Path, help="WebP to write")
    parser.add_argument("--seed", type=int, default=0, help="of world, noise and drift")
    given = parser.parse_args()
    network, _ = load_detector(given.folder)
    config = compose(["track=split_s"])
    settings = settings_of(PerceptionSettings, config["perception"], "perception")
    steady = replace(settings.images, period=APART, gain=[1.0, 1.0], vignetting=[0.2, 0.2])  # no flicker
    track = track_from(settings_of(TrackSettings, config["track"], "track"))
    eye = Eye(network, replace(settings, images=steady), "cpu")
    pictures = [drawn(each, track) for each in instants(eye, track, given.seed)]
    pictures[0].save(
        given.file,
        save_all=True,
        append_images=pictures[1:],
        duration=round(1000 * APART),
        loop=0,
        quality=QUALITY,
        method=6,
    )


if __name__ == "__main__":
    main()
