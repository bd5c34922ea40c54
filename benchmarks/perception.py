"""Drift-corrected odometry over three laps: python -m benchmarks.perception [perception.KEY=VALUE ...]

A machine flies a smooth line through the gates of a track. Its odometry drifts; its camera sees the gates, whose
corners are known to a pixel or so. The tables are those of docs/perception.md.
"""

import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline

from benchmarks.page import table
from simgap.api.inputs import settings_of
from simgap.gates.settings import TrackSettings
from simgap.gates.track import Track, track_from
from simgap.perception.camera import Camera, camera_from, project, sees, unproject
from simgap.perception.correction import DriftCorrection
from simgap.perception.pose import Belief, fixes_from
from simgap.perception.settings import PerceptionSettings
from simgap.perception.view import View, view
from simgap.physics import rotations
from simgap.runner.compose import compose

Array = NDArray[np.float64]

PERIOD = 0.01  # s, of the odometry
EVERY = 4  # steps from image to image: 40 ms, the published time of the detector for one image
SPEED = 9.0  # m/s, in the gates
LONGER = 1.15  # a curve through the gates over the straight lines
SLOWEST = 0.8  # s, least from gate to gate: half a loop takes that long
FORGETS = 2.0  # s, correlation time of the odometry's errors
TILT = 0.01  # rad about each axis, standard deviation of the error of its attitude
GRAVITY = np.array([0.0, 0.0, 9.81])  # m/s²
LAPS = 3
SEEDS = range(5)
DRIFTS = (0.1, 0.3, 1.0)  # m/s, by which velocity is misjudged along each axis
NOISES = (0.5, 1.0, 2.0)  # px
FALSE = (0.0, 0.7)  # false gates in an image on average; the detector of docs/perception.md sees so many
FALSE_FROM = (1.5, 20.0)  # m, their distances
REACHES = (0.0, 3.0, 6.0, 9.0, 12.0, 20.0)  # m


@dataclass(frozen=True)
class Flight:
    """What truly happens, a `PERIOD` apart: position (steps, 3) m, velocity (steps, 3) m/s, attitude (steps, 4)."""

    position: Array
    velocity: Array
    attitude: Array

    @property
    def way(self) -> float:
        """Length of the line, m."""
        return float(np.linalg.norm(np.diff(self.position, axis=0), axis=-1).sum())


def flown(track: Track, laps: int = LAPS, speed: float = SPEED) -> Flight:
    """Return a flight through the middles of the gates.

    Thrust balances gravity and acceleration, so the body's z axis follows from the line. Its x axis looks at the next
    gate.
    """
    order = np.arange(laps * len(track) + 1) % len(track)
    gates, directions = (part.double().numpy()[order] for part in (track.centres, track.axes[:, 0]))
    apart = np.linalg.norm(np.diff(gates, axis=0), axis=-1)
    times = np.concatenate(([0.0], np.maximum(LONGER * apart / speed, SLOWEST).cumsum()))
    line = CubicHermiteSpline(times, gates, speed * directions)
    now = np.arange(0.0, times[-1], PERIOD)
    position = line(now)
    up = _unit(line(now, 2) + GRAVITY)
    ahead = gates[np.searchsorted(times, now, side="right")] - position
    forward = _unit(ahead - (ahead * up).sum(-1, keepdims=True) * up)
    turn = np.stack((forward, np.cross(up, forward), up), axis=-1)
    return Flight(position, line(now, 1), rotations.from_matrix(torch.from_numpy(turn)).numpy())


def states_of(flight: Flight) -> Array:
    """Return position, velocity (world), attitude, body rate, (steps, 13)."""
    attitude = torch.from_numpy(flight.attitude)
    turn = rotations.multiply(rotations.conjugate(attitude[:-1]), attitude[1:])
    rate = torch.nn.functional.pad(rotations.to_rotation_vector(turn) / PERIOD, (0, 0, 0, 1))
    return np.concatenate((flight.position, flight.velocity, flight.attitude, rate.numpy()), axis=-1)


def odometry_of(flight: Flight, misjudged: float, random: np.random.Generator) -> Flight:
    """Return what an odometry believes: velocity is off by first-order noise, and position by its integral.

    Args:
        flight: what truly happens.
        misjudged: standard deviation of the velocity's error along each axis, m/s.
        random: of the errors.
    """
    velocity = misjudged * _first_order(flight.velocity.shape, random)
    tilt = torch.from_numpy(TILT * _first_order(flight.velocity.shape, random))
    attitude = rotations.multiply(torch.from_numpy(flight.attitude), rotations.from_rotation_vector(tilt))
    drift = PERIOD * np.cumsum(velocity, axis=0)
    return Flight(flight.position + drift, flight.velocity + velocity, attitude.numpy())


def corrected(
    settings: PerceptionSettings,
    track: Track,
    flight: Flight,
    odometry: Flight,
    seed: int,
    found: Mapping[int, Array],
) -> Flight:
    """Return the odometry with its drift taken off by what the camera sees.

    Args:
        settings: of the perception.
        track: its gates.
        flight: what truly happens.
        odometry: what is believed of it.
        seed: of the perturbations.
        found: corners of the gates in the images, by step.
    """
    correction = DriftCorrection(settings, track, seed)
    estimates = []
    for step in range(len(flight.position)):
        correction.advance(PERIOD)
        if step in found:
            correction.see(found[step], Belief(odometry.position[step], odometry.attitude[step]))
        estimates.append(correction.corrected(odometry.position[step], odometry.velocity[step]))
    position, velocity = (np.stack(part) for part in zip(*estimates, strict=True))
    return Flight(position, velocity, odometry.attitude)


def noisy_corners(
    settings: PerceptionSettings, track: Track, flight: Flight, seed: int, every: int, false: float = 0.0
) -> dict[int, Array]:
    """Return the corners of the gates in view with the noise of a detector, by step, with false gates among them.

    Args:
        settings: of the perception.
        track: its gates.
        flight: what truly happens.
        seed: of the noise.
        every: steps from image to image.
        false: number of gates in an image that are not there, on average.
    """
    random, of_false = np.random.default_rng(seed), np.random.default_rng([seed, 2])
    seen, camera = seen_along(settings, track, flight), camera_from(settings.camera)
    found = {}
    for step in range(0, len(flight.position), every):
        corners = seen.corners[step][seen.visible[step]].numpy()
        noisy = corners + settings.corners.noise * random.standard_normal(corners.shape)
        found[step] = np.concatenate((noisy, false_gates(camera, track.opening, false, of_false)))
    return found


def false_gates(camera: Camera, opening: float, mean: float, random: np.random.Generator) -> Array:
    """Return corners of squares that face the camera from anywhere in the image, a Poisson number, (gates, 4, 2) px."""
    count = random.poisson(mean)
    pixels = torch.from_numpy(random.uniform(0.0, camera.size, (count, 2)))
    distance = np.exp(random.uniform(*np.log(FALSE_FROM), (count, 1)))
    middles = torch.from_numpy(distance) * unproject(camera, pixels)
    around = 0.5 * opening * torch.tensor([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    corners = middles[:, None] + torch.nn.functional.pad(around.to(middles), (0, 1))
    return project(camera, corners)[sees(camera, corners).all(-1)].numpy()


def seen_along(settings: PerceptionSettings, track: Track, flight: Flight) -> View:
    """Return what the camera sees at every step."""
    state = torch.from_numpy(flight.position), torch.from_numpy(flight.attitude)
    return view(camera_from(settings.camera), track, *state)


def error_of(flight: Flight, believed: Flight, name: str = "position") -> float:
    """Return the RMS error of the position, m, or of the velocity, m/s."""
    wrong = getattr(believed, name) - getattr(flight, name)
    return float(np.sqrt((wrong**2).sum(-1).mean()))


def errors_of(settings: PerceptionSettings, track: Track, misjudged: float, false: float = 0.0) -> Array:
    """Return RMS errors of position, m, and velocity, m/s, by odometry alone and corrected, (seeds, 2, 2)."""
    flight, errors = flown(track), []
    for seed in SEEDS:
        odometry = odometry_of(flight, misjudged, np.random.default_rng([seed, 1]))
        found = noisy_corners(settings, track, flight, seed, EVERY, false)
        estimates = odometry, corrected(settings, track, flight, odometry, seed, found)
        errors.append(
            [[error_of(flight, each, name) for each in estimates] for name in ("position", "velocity")]
        )
    return np.array(errors)


def fixes_along(
    settings: PerceptionSettings, track: Track, flight: Flight, seed: int, every: int
) -> Iterator[tuple[float, Array, Array]]:
    """Yield distance to the gate, m, error (3,) m and covariance (3, 3) m² of the positions that single gates give.

    The position is believed exactly, the attitude as odometry has it.
    """
    camera, gates = camera_from(settings.camera), track.to(torch.float64)
    random = np.random.default_rng(seed)
    believed = odometry_of(flight, 0.0, np.random.default_rng([seed, 1]))
    for step, noisy in noisy_corners(settings, track, flight, seed, every).items():
        belief = Belief(believed.position[step], believed.attitude[step])
        for fix in fixes_from(camera, gates, noisy, belief, settings.corners, random):
            distance = np.linalg.norm(gates.centres[fix.gate].numpy() - flight.position[step])
            yield float(distance), fix.position - flight.position[step], fix.covariance


def _unit(vectors: Array) -> Array:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def _first_order(shape: tuple[int, ...], random: np.random.Generator) -> Array:
    """Return first-order noise of variance one along the first axis."""
    kept = np.exp(-PERIOD / FORGETS)
    noise = random.standard_normal(shape)
    noise[1:] *= np.sqrt(1.0 - kept**2)
    for before, now in pairwise(noise):
        now += kept * before
    return noise


def _drift_table(settings: PerceptionSettings, track: Track) -> str:
    rows = []
    for misjudged in DRIFTS:
        position, velocity = errors_of(settings, track, misjudged).transpose(1, 2, 0)
        ratio = position[0] / position[1]
        cells = [_spread(each) for each in (*position, ratio, *velocity)]
        rows.append([f"{misjudged:g}", *cells[:3], f"{ratio.min():.1f}", *cells[3:]])
    head = ["velocity misjudged by, m/s", "odometry alone, m", "with the gates, m", "ratio", "least ratio"]
    return table([*head, "odometry alone, m/s", "with the gates, m/s"], rows)


def _reading_table(settings: PerceptionSettings, track: Track) -> str:
    published = settings.drift
    readings = {
        "σ": (published.position, published.velocity),
        "σ²": (published.position**2, published.velocity**2),
        "σ for each second": (PERIOD * published.position, PERIOD * published.velocity),
    }
    rows = []
    for name, (position, velocity) in readings.items():
        drift = replace(published, position=position, velocity=velocity)
        errors = errors_of(replace(settings, drift=drift), track, DRIFTS[1])[:, :, 1].T
        rows.append([name, f"{position:g}", f"{velocity:g}", *(_spread(each) for each in errors)])
    return table(["in Q", "m²", "m²/s²", "with the gates, m", "with the gates, m/s"], rows)


def _false_table(settings: PerceptionSettings, track: Track) -> str:
    rows = []
    for false in FALSE:
        rows.append([f"{false:g}"])
        for taken in (1.0, settings.drift.taken):
            chosen = replace(settings, drift=replace(settings.drift, taken=taken))
            rows[-1] += [_spread(each) for each in errors_of(chosen, track, DRIFTS[1], false)[:, :, 1].T]
    head = ["false gates in an image", "all taken in, m", "all taken in, m/s"]
    return table([*head, "checked, m", "checked, m/s"], rows)


def _pose_table(settings: PerceptionSettings, track: Track) -> str:
    rows = []
    for noise in NOISES:
        noisy = replace(settings, corners=replace(settings.corners, noise=noise))
        found = list(fixes_along(noisy, track, flown(track), seed=0, every=10))
        distance = np.array([each[0] for each in found])
        error = np.linalg.norm([each[1] for each in found], axis=-1)
        within = [error[(distance >= low) & (distance < high)] for low, high in pairwise(REACHES)]
        rows.append(
            [f"{noise:g}", *(f"{np.median(part):.2f} ({np.quantile(part, 0.9):.2f})" for part in within)]
        )
    return table(["noise, px", *(f"{low:g} to {high:g} m" for low, high in pairwise(REACHES))], rows)


def _spread(values: Array) -> str:
    return f"{np.mean(values):.2f} ± {np.std(values, ddof=1):.2f}"


def main(overrides: Sequence[str]) -> None:
    """Print the tables."""
    config = compose(["track=split_s", *overrides])
    settings = settings_of(PerceptionSettings, config["perception"], "perception")
    track = track_from(settings_of(TrackSettings, config["track"], "track"))
    flight = flown(track)
    seen = seen_along(settings, track, flight).visible.sum(-1).double()
    seconds = PERIOD * len(flight.position)
    print(f"{config['track']['name']}: {LAPS} laps, {flight.way:.0f} m in {seconds:.1f} s,", end=" ")
    print(
        f"{float(seen.mean()):.1f} gates in view on average, none for {float((seen == 0).double().mean()):.1%}\n"
    )
    for part in (_pose_table, _drift_table, _false_table, _reading_table):
        print(part(settings, track), flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
