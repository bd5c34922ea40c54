"""What a gate detector finds on tracks that it has not learned: python -m benchmarks.detector FOLDER

FOLDER is that of a detector (simgap train_detector). A machine flies smooth lines through the gates of two tracks, and
its camera's images are rendered. The tables are those of docs/perception.md. A GPU is used where there is one.
"""

import argparse
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pandas as pd
import torch
from torch import Tensor

from benchmarks.page import table
from benchmarks.perception import (
    DRIFTS,
    EVERY,
    SEEDS,
    Array,
    Flight,
    corrected,
    error_of,
    flown,
    noisy_corners,
    odometry_of,
    states_of,
)
from simgap.api.inputs import settings_of
from simgap.gates.settings import TrackSettings
from simgap.gates.track import Track, track_from
from simgap.perception.camera import camera_from
from simgap.perception.corners import gates_in
from simgap.perception.detector import Detector, Maps
from simgap.perception.eye import Eye, motion_of
from simgap.perception.learning import Learning
from simgap.perception.render import Motion, unhidden
from simgap.perception.settings import PerceptionSettings
from simgap.perception.storage import load_detector
from simgap.perception.view import upright, view
from simgap.runner.compose import compose

TRACKS = ("split_s", "figure_eight")
SPEEDS = (5.0, 9.0, 15.0)  # m/s, in the gates
APART = 40  # steps from image to image
NEAR = 5.0  # px, mean over the corners, within which a gate counts as found
TOGETHER = {"cpu": 8, "cuda": 16}  # images
DISTANCES = (0.0, 3.0, 6.0, 9.0, 12.0, 20.0)  # m
RATES = (0.0, 5.0, 10.0, 15.0, 25.0)  # m/s
ANGLES = (0.0, 20.0, 40.0, 60.0, 75.0, 90.0)  # degrees


@dataclass(frozen=True)
class Shot:
    """An image, what was found in it, and the gates that it shows wholly.

    Attributes:
        step: of the flight.
        image: (height, width), from 0 to 1.
        found: corners of the gates that were found, (gates, 4, 2) px.
        shown: numbers of the gates of which nothing hides a corner.
        corners: of these, (gates, 4, 2) px.
    """

    step: int
    image: Array
    found: Array
    shown: Array
    corners: Array


def shots(eye: Eye, track: Track, flight: Flight, every: int, seed: int) -> Iterator[Shot]:
    """Yield what is found along a flight, in a new world for each image."""
    random = torch.Generator(eye.device).manual_seed(seed)
    motion = moving(flight, every, eye.device)
    steps = np.arange(0, len(flight.position), every)
    camera, together = eye.camera, TOGETHER[eye.device]
    parts = zip(*(part.split(together) for part in vars(motion).values()), strict=True)
    for number, part in enumerate(parts):
        now = Motion(*part)
        scene = eye.scene(track, now.position, random)
        seen = view(camera, track.to(eye.device), now.position, now.attitude)
        shown = unhidden(scene, now, camera, seen).all(-1).cpu().numpy()
        images = eye.renderer.images(scene, now, random)
        corners = seen.corners.double().cpu().numpy()
        for row, gates in enumerate(eye.found(images)):
            gates = upright(camera, torch.from_numpy(gates), now.attitude[row].double().cpu()).numpy()
            which = np.flatnonzero(shown[row])
            step = int(steps[number * together + row])
            yield Shot(step, images[row, 0].cpu().numpy(), gates, which, corners[row, which])


def moving(flight: Flight, every: int, device: str) -> Motion:
    """Return how a machine moves at some steps of a flight."""
    return motion_of(states_of(flight)[:-1][::every], device)


def matched(shot: Shot) -> tuple[Array, int]:
    """Return the mean corner error of each gate that is shown, px, not a number where it was not found; and how many
    gates were found that are not there."""
    errors = np.full(len(shot.shown), np.nan)
    false = 0
    for gate in shot.found:
        apart = np.linalg.norm(shot.corners - gate, axis=-1).mean(-1)
        best = int(apart.argmin()) if len(apart) else -1
        if best >= 0 and apart[best] < NEAR:
            errors[best] = apart[best]
        else:
            false += 1
    return errors, false


def scored(eye: Eye, track: Track, flight: Flight, seed: int) -> tuple[pd.DataFrame, int, int]:
    """Return a row for every gate that an image shows, the number of images and that of false gates."""
    rows, images, false = [], 0, 0
    for shot in shots(eye, track, flight, APART, seed):
        errors, wrong = matched(shot)
        images, false = images + 1, false + wrong
        sight = track.centres.numpy()[shot.shown] - flight.position[shot.step]
        distance = np.linalg.norm(sight, axis=-1)
        normal = np.abs((sight * track.axes.numpy()[shot.shown, 0]).sum(-1)) / distance
        speed = float(np.linalg.norm(flight.velocity[shot.step]))
        angle = np.degrees(np.arccos(normal.clip(max=1.0)))
        rows += list(zip(distance, [speed] * len(errors), angle, errors, strict=True))
    return pd.DataFrame(rows, columns=["distance", "speed", "angle", "error"]), images, false


def seconds(work: Callable[[], object], device: str, least: int = 20) -> float:
    """Return the median time of some calls."""
    times = []
    for _ in range(least + 5):
        begin = time.perf_counter()
        work()
        if device == "cuda":
            torch.cuda.synchronize()
        times.append(time.perf_counter() - begin)
    return float(np.median(times[5:]))


def _finding_table(eye: Eye, tracks: dict[str, Track]) -> str:
    parts, images, false = [], 0, 0
    for name, track in tracks.items():
        for seed, speed in enumerate(SPEEDS):
            found, some, wrong = scored(eye, track, flown(track, laps=1, speed=speed), seed)
            parts.append(found.assign(track=name))
            images, false = images + some, false + wrong
    found = pd.concat(parts)
    rows = [_finding("all", found)]
    rows += [_finding(name, found[found["track"] == name]) for name in tracks]
    for column, ends, unit in (("distance", DISTANCES, "m"), ("speed", RATES, "m/s"), ("angle", ANGLES, "°")):
        for low, high in pairwise(ends):
            within = found[(found[column] >= low) & (found[column] < high)]
            rows.append(_finding(f"{column} {low:g} to {high:g} {unit}", within))
    head = ["gates", "number", "found", "median error, px", "90 % below, px"]
    return f"{images} images, {false} false gates\n\n" + table(head, rows)


def _finding(name: str, found: pd.DataFrame) -> list[str]:
    if found.empty:
        return [name, "0", "", "", ""]
    error = found["error"].dropna()
    share = f"{len(error) / len(found):.1%}"
    return [name, str(len(found)), share, f"{error.median():.2f}", f"{error.quantile(0.9):.2f}"]


def _drift_table(eye: Eye, track: Track) -> str:
    """Say what is left of the drift with corners of the detector, beside exact corners with noise."""
    flight = flown(track)
    found = {
        seed: {shot.step: shot.found for shot in shots(eye, track, flight, EVERY, 100 + seed)}
        for seed in SEEDS
    }
    rows = []
    for misjudged in DRIFTS:
        errors = []
        for seed in SEEDS:
            odometry = odometry_of(flight, misjudged, np.random.default_rng([seed, 1]))
            estimates = (
                odometry,
                *(
                    corrected(eye.settings, track, flight, odometry, seed, corners)
                    for corners in (noisy_corners(eye.settings, track, flight, seed, EVERY), found[seed])
                ),
            )
            errors.append([error_of(flight, each) for each in estimates])
        alone, exact, seen = np.array(errors).T
        ratio = alone / seen
        cells = [f"{np.mean(each):.2f} ± {np.std(each, ddof=1):.2f}" for each in (alone, exact, seen, ratio)]
        rows.append([f"{misjudged:g}", *cells, f"{ratio.min():.1f}"])
    head = ["velocity misjudged by, m/s", "odometry alone, m", "corners with noise, m", "detected corners, m"]
    return table([*head, "ratio", "least ratio"], rows)


def _speed_table(network: Detector, settings: PerceptionSettings, device: str) -> str:
    """Say how fast images are drawn and learned from, and how long the detector takes for one."""
    batch = settings.detector.learning.batch if device == "cuda" else 4
    learning = replace(settings.detector.learning, batch=batch)
    module = Learning(network, replace(settings, detector=replace(settings.detector, learning=learning)), 0)
    module.to(device).on_fit_start()
    optimizer = torch.optim.Adam(network.parameters(), lr=0.0)
    images, wanted = module.examples(0)

    def learn() -> None:
        optimizer.zero_grad()
        module.loss(images, wanted).backward()
        optimizer.step()

    few = 20 if device == "cuda" else 3
    rows = [
        [
            "images drawn, with targets, a second",
            f"{batch / seconds(lambda: module.examples(0), device, few):.0f}",
        ],
        ["images learned from, a second", f"{batch / seconds(learn, device, few):.0f}"],
    ]
    precisions = {"single": torch.float32} | ({"half": torch.float16} if device == "cuda" else {})
    for name, precision in precisions.items():
        maps = Maps(network).eval().to(device, precision)
        one = images[:1].to(precision)
        rows.append([f"maps of one image, {name} precision, ms", f"{1e3 * _latency(maps, one, device):.2f}"])
    network.float()
    found = Maps(network).eval()(images[:1]).detach()
    camera = camera_from(settings.camera)
    grouping = seconds(lambda: gates_in(found, camera, settings.detector), device)
    rows.append(["gates from the maps of one image, ms", f"{1e3 * grouping:.2f}"])
    return table(["", torch.cuda.get_device_name() if device == "cuda" else "CPU"], rows)


@torch.no_grad()
def _latency(maps: Maps, one: Tensor, device: str) -> float:
    return seconds(lambda: maps(one), device)


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.detector", description=__doc__)
    parser.add_argument("folder", type=Path, help="of a detector")
    parser.add_argument("--picture", type=Path, help="PNG of images with the corners that were found")
    parser.add_argument("--only", choices=("finding", "drift", "speed"), help="one of the tables")
    given = parser.parse_args()
    network, settings = load_detector(given.folder)
    device = "cuda" if torch.cuda.is_available() else "cpu"
    tracks = {
        name: track_from(settings_of(TrackSettings, compose([f"track={name}"])["track"], "track"))
        for name in TRACKS
    }
    eye = Eye(network, settings, device)
    if given.picture:
        from benchmarks.detector_picture import draw

        draw(list(shots(eye, tracks["split_s"], flown(tracks["split_s"], laps=1), 60, 0)), given.picture)
    tables = {
        "finding": lambda: _finding_table(eye, tracks),
        "drift": lambda: _drift_table(eye, tracks["split_s"]),
        "speed": lambda: _speed_table(network, settings, device),
    }
    for name in [given.only] if given.only else tables:
        print(tables[name](), flush=True)


if __name__ == "__main__":
    main()
