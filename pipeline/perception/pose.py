"""The position of a machine from the corners of one gate of a known track.

Infinitesimal plane-based pose estimation (IPPE; Collins & Bartoli 2014, IJCV 109, as OpenCV implements it) gives the
pose of a square from its four corners in closed form: a rotation R and a translation t with p_camera = R p_gate + t.

Two such poses fit the corners of a small or distant square almost equally well. Both put it at about the same place, so
that either says which gate it is, but they lean it to opposite sides of the line of sight. The odometry's attitude
chooses between them, because that drifts little: the pose is taken whose gate stands most nearly as the track says.
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

# OpenCV's square has x to the right, y up and z towards the camera; a gate has away, left and up.
_SQUARE_FROM_GATE = np.array([[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]])
_SIDES = np.stack((np.eye(3), np.diag([-1.0, -1.0, 1.0])))  # a gate as it is to be passed, and from behind
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
class GatePoses:
    """Two poses of a gate for each of several sets of its corners, the one that fits better first.

    Attributes:
        turns: R, from the gate's away, left and up as the camera sees it, (sets, 2, 3, 3).
        translations: t, the middle of the gate in the camera's frame, (sets, 2, 3) m.
    """

    turns: Array
    translations: Array


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


def gate_poses(rays: Array, opening: float) -> GatePoses:
    """Return the poses of a gate that its corners allow; not a number for sets that are the corners of no square.

    Args:
        rays: directions of its corners in the camera's frame, less than 90° from its axis, in the order of
            `simgap.perception.view.View`, (sets, 4, 3).
        opening: inner side of the gate, m.
    """
    left, up = 0.5 * opening * np.array([[-1.0, 1.0, 1.0, -1.0], [1.0, 1.0, -1.0, -1.0]])
    square = np.stack((left, up, np.zeros(4)), axis=-1)
    found = np.stack([_solutions(square, image) for image in rays[..., :2] / rays[..., 2:]])
    vectors, translations = found[:, 0], found[:, 1]
    turns = rotations.to_matrix(rotations.from_rotation_vector(torch.from_numpy(vectors))).numpy()
    in_front = np.where(translations[..., 2:] > 0, translations, np.nan)
    return GatePoses(turns @ _SQUARE_FROM_GATE, in_front)


def _solutions(square: Array, image: Array) -> Array:
    """Return two rotation vectors and two translations, (2, 2, 3); not a number where OpenCV finds none."""
    _, *found, _ = cv2.solvePnPGeneric(square, image, np.eye(3), None, flags=cv2.SOLVEPNP_IPPE_SQUARE)
    whole = np.shape(found) == (2, 2, 3, 1)
    return np.array(found)[..., 0] if whole else np.full((2, 2, 3), np.nan)


def nearest_gate(camera: Camera, track: Track, seen: Array, belief: Belief) -> int:
    """Return the gate of the track that is nearest to what is seen at a place in the camera's frame, (3,) m."""
    body = _matrix(belief.attitude)
    middle = belief.position + body @ (camera.position.numpy() + camera.axes.numpy().T @ seen)
    return int(np.linalg.norm(track.centres.numpy() - middle, axis=-1).argmin())


def positions_from(camera: Camera, track: Track, gate: int, poses: GatePoses, attitude: Array) -> Array:
    """Return where a machine is in the world if it sees a gate in these poses, (sets, 3) m.

    With the gate's middle c and its axes as rows of A, the camera is at c − Aᵀ Rᵀ t. Of the two poses, and of the two
    sides from which the gate may be seen, those are taken that turn the believed attitude least.
    """
    to_camera = camera.axes.numpy() @ _matrix(attitude).T
    sides = _SIDES @ track.axes[gate].numpy()
    # The trace of the turn between both attitudes, which grows as its angle falls.
    alike = np.einsum("spij,ik,qjk->sqp", poses.turns, to_camera, sides)
    side, pose = np.divmod(alike.reshape(len(alike), -1).argmax(-1), alike.shape[-1])
    sets = np.arange(len(alike))
    to_world = np.swapaxes(poses.turns[sets, pose] @ sides[side], -1, -2)
    from_body = poses.translations[sets, pose] + camera.axes.numpy() @ camera.position.numpy()
    return track.centres[gate].numpy() - (to_world @ from_body[..., None])[..., 0]


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
    (Kaufmann et al. 2023, Nature 620, Methods: 20).

    Args:
        camera: on the machine.
        track: its gates, in double precision as everything here.
        corners: in the order of `simgap.perception.view.View`, (gates, 4, 2) px.
        belief: of the machine, its drift taken off as far as it is known.
        settings: of the corners.
        random: of the perturbations.
    """
    noise = settings.noise * random.standard_normal((len(corners), settings.samples, 4, 2))
    perturbed = np.concatenate((corners[:, None], corners[:, None] + noise), axis=1)
    sets = unproject(camera, torch.from_numpy(perturbed)).numpy()
    return [fix for rays in sets if (fix := _fix_from(camera, track, rays, belief))]


def _fix_from(camera: Camera, track: Track, rays: Array, belief: Belief) -> Fix | None:
    poses = gate_poses(rays, track.opening)
    gate = nearest_gate(camera, track, poses.translations[0, 0], belief)
    positions = positions_from(camera, track, gate, poses, belief.attitude)
    known = np.isfinite(positions.sum(-1))
    if not known[0] or known.sum() < _LEAST:
        return None
    return Fix(gate, positions[0], np.cov(positions[known].T))


def _matrix(attitude: Array) -> Array:
    return rotations.to_matrix(torch.from_numpy(attitude)).numpy()
