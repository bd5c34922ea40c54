"""Cameras and views as the tests of perception have them."""

from dataclasses import replace

import numpy as np
import torch
from omegaconf import OmegaConf

from simgap.gates.track import Track
from simgap.perception.camera import Camera, camera_from
from simgap.perception.pose import Belief
from simgap.perception.settings import CameraSettings, PerceptionSettings
from simgap.perception.view import view
from simgap.physics import rotations
from tests.pipeline.gates.tracks import CONF, track_named


def perception() -> PerceptionSettings:
    """Return the configuration of the project."""
    file = OmegaConf.load(CONF / "perception" / "default.yaml")
    settings = OmegaConf.to_object(OmegaConf.merge(OmegaConf.structured(PerceptionSettings), file))
    assert isinstance(settings, PerceptionSettings)
    return settings


def fisheye(**changed) -> Camera:
    return camera_from(replace(perception().camera, **changed))


def pinhole_settings(**changed) -> CameraSettings:
    plain = CameraSettings("pinhole", [640, 480], [400.0, 410.0], [319.5, 239.5], [], 2.0, [640, 480], 0.0)
    return replace(plain, **changed)


def course() -> Track:
    """Return the Split-S course, its gates square to the last digit of double precision.

    As one faces a square, its pose hangs on the root of what its corners are off by.
    """
    track = track_named("split_s").to(torch.float64)
    return replace(track, axes=track.axes / track.axes.norm(dim=-1, keepdim=True))


def standing_before(
    track: Track, gate: int, metres: float, across: float = 0.0, turned: float = 0.0
) -> Belief:
    """Return a level machine that looks at a gate from some way before it.

    Args:
        track: its gates.
        gate: which of them.
        metres: before its middle; negative: behind it.
        across: to its left, m.
        turned: about the body's axes from there, rad each.
    """
    centre, axes = track.centres[gate], track.axes[gate]
    position = centre - metres * axes[0] + across * axes[1]
    forward = (centre - position) / (centre - position).norm()
    up = torch.tensor([0.0, 0.0, 1.0]).to(forward)
    facing = rotations.from_matrix(torch.stack((forward, rotations.cross(up, forward), up), dim=-1))
    turn = rotations.from_rotation_vector(torch.full((3,), turned).to(forward))
    return Belief(position.numpy(), rotations.multiply(facing, turn).numpy())


def corners_of(camera: Camera, track: Track, machine: Belief) -> dict[int, np.ndarray]:
    """Return the corners of the gates that a machine sees, (4, 2) px each, by gate."""
    seen = view(camera, track, torch.from_numpy(machine.position), torch.from_numpy(machine.attitude))
    return {gate: seen.corners[gate].numpy() for gate in np.flatnonzero(seen.visible.numpy()).tolist()}
