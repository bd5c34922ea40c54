"""The position of a machine from the corners of one gate of a known track.

Infinitesimal plane-based pose estimation (IPPE; Collins & Bartoli 2014, IJCV 109, as OpenCV implements it) gives the
pose of a square from its four corners in closed form: a rotation R and a translation t with p_camera = R p_gate + t.

R is the noisiest part of it, and two of them fit the corners of a small or distant square almost equally well. So only
t is taken, the middle of the gate as the camera sees it; the attitude, which drifts little, is that of the odometry.
"""

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
import torch
from numpy.typing import NDArray

from simgap.gates.track import Track
from simgap.perception.camera import Camera, unproject
from simgap.perception.settings import CornerSettings
from simgap.physics import rotations

Array = NDArray[Any]

_LEAST = 4  # positions whose covariance can have full rank


@dataclass(frozen=True)
class Belief:
    """Where a machine believes that it is.

    Attributes:
        position: world frame, (3,) m.
        attitude: unit quaternion, body to world, (4,).
    """

    position: Array
    attitude: Array


@dataclass(frozen=True)
class Fix:
    """A measured position of a machine.

    Attributes:
        gate: of the track, from which it was measured.
        position: of the machine, world frame, (3,) m.
        covariance: of the position, (3, 3) m².
    """

    gate: int
    position: Array
    covariance: Array


def middles_seen(rays: Array, opening: float) -> Array:
    """Return t, the middle of a gate in the camera's frame, for each of several sets of its corners, (sets, 3) m.

    It is not a number for sets that are the corners of no square.

    Args:
        rays: directions of its corners in the camera's frame, less than 90° from its axis, clockwise from any of them,
            (sets, 4, 3).
        opening: inner side of the gate, m.
    """
    left, up = 0.5 * opening * np.array([[-1.0, 1.0, 1.0, -1.0], [1.0, 1.0, -1.0, -1.0]])
    square = np.stack((left, up, np.zeros(4)), axis=-1)
    found = np.stack([_middle(square, image) for image in rays[..., :2] / rays[..., 2:]])
    return np.where(found[:, 2:] > 0, found, np.nan)


def _middle(square: Array, image: Array) -> Array:
    """Return the translation that fits best, (3,); not a number where OpenCV finds none."""
    known, _, middle = cv2.solvePnP(square, image, np.eye(3), None, flags=cv2.SOLVEPNP_IPPE_SQUARE)
    return middle[:, 0] if known else np.full(3, np.nan)


def nearest_gate(camera: Camera, track: Track, seen: Array, belief: Belief) -> int:
    """Return the gate of the track that is nearest to what is seen at a place in the camera's frame, (3,) m."""
    body = _matrix(belief.attitude)
    middle = belief.position + body @ (camera.position.numpy() + camera.axes.numpy().T @ seen)
    return int(np.linalg.norm(track.centres.numpy() - middle, axis=-1).argmin())


def positions_from(camera: Camera, track: Track, gate: int, middles: Array, attitudes: Array) -> Array:
    """Return where a machine is in the world if it sees a gate at these places, (sets, 3) m.

    With the gate's middle c, the body's rotation B into the world, and the camera's place b and axes C on the body, the
    machine is at c − B (b + Cᵀ t).

    Args:
        camera: on the machine.
        track: its gates.
        gate: which of them is seen.
        middles: t, of the gate in the camera's frame, (sets, 3) m.
        attitudes: of the machine as believed with each of them, body to world, (sets, 4).
    """
    on_body = camera.position.numpy() + middles @ camera.axes.numpy()
    return track.centres[gate].numpy() - (_matrix(attitudes) @ on_body[..., None])[..., 0]


def fixes_from(
    camera: Camera,
    track: Track,
    corners: Array,
    belief: Belief,
    settings: CornerSettings,
    random: np.random.Generator,
) -> list[Fix]:
    """Return the machine's position from the corners of each gate of an image; none from those of no square.

    A covariance is that of the positions from the nominal corners and from `settings.samples` sets of perturbed ones
    (Kaufmann et al. 2023, Nature 620, Methods: 20), each with a perturbed attitude.

    Args:
        camera: on the machine.
        track: its gates, in double precision as everything here.
        corners: clockwise as the image shows them, from any of them, (gates, 4, 2) px.
        belief: of the machine, its drift taken off as far as it is known.
        settings: of the corners and of the attitude.
        random: of the perturbations.
    """
    noise = settings.noise * random.standard_normal((len(corners), settings.samples, 4, 2))
    perturbed = np.concatenate((corners[:, None], corners[:, None] + noise), axis=1)
    attitudes = _with_perturbed(belief.attitude, settings, random)
    sets = unproject(camera, torch.from_numpy(perturbed)).numpy()
    return [fix for rays in sets if (fix := _fix_from(camera, track, rays, belief, attitudes))]


def _with_perturbed(attitude: Array, settings: CornerSettings, random: np.random.Generator) -> Array:
    """Return an attitude and those that it may be in truth, (1 + samples, 4)."""
    tilts = settings.tilt * random.standard_normal((settings.samples, 3))
    turns = rotations.from_rotation_vector(torch.from_numpy(np.concatenate((np.zeros((1, 3)), tilts))))
    return rotations.multiply(torch.from_numpy(attitude).to(turns).expand(len(turns), 4), turns).numpy()


def _fix_from(camera: Camera, track: Track, rays: Array, belief: Belief, attitudes: Array) -> Fix | None:
    middles = middles_seen(rays, track.opening)
    gate = nearest_gate(camera, track, middles[0], belief)
    positions = positions_from(camera, track, gate, middles, attitudes)
    known = np.isfinite(positions.sum(-1))
    if not known[0] or known.sum() < _LEAST:
        return None
    return Fix(gate, positions[0], np.cov(positions[known].T))


def _matrix(attitude: Array) -> Array:
    return rotations.to_matrix(torch.from_numpy(attitude)).numpy()
