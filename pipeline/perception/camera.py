"""Cameras: where points appear in an image, and in which direction a pixel looks.

The camera's frame has x to the right, y down and z along the optical axis. A point at an angle θ to the axis appears
at a distance d(θ) from the principal point, in focal lengths:

- pinhole: d = tan θ
- fisheye: d = θ (1 + k₁θ² + k₂θ⁴ + k₃θ⁶ + k₄θ⁸) (Kannala & Brandt 2006, IEEE TPAMI 28)
"""

import math
from dataclasses import dataclass

import torch
from torch import Tensor

from simgap.errors import InputError
from simgap.perception.settings import CameraSettings
from simgap.physics import rotations
from simgap.physics.shapes import Pair, Quaternion, Real, Vector

PINHOLE, FISHEYE = "pinhole", "fisheye"
_NEWTON_STEPS = 8  # four suffice for a T265, to rounding in double precision
_WHERE = "perception.camera"


@dataclass(frozen=True)
class Camera:
    """A camera on a machine.

    Attributes:
        size: width and height of its images, px.
        focal: along x and y, px.
        centre: principal point, px; the first pixel's middle is at 0.
        distortion: k₁ to k₄; None: a pinhole.
        widest: angle to the optical axis up to which the lens draws, rad.
        axes: rows are its x, y and z axis in the body frame, (3, 3).
        position: on the body, (3,) m.
    """

    size: tuple[int, int]
    focal: tuple[float, float]
    centre: tuple[float, float]
    distortion: tuple[float, ...] | None
    widest: float
    axes: Tensor
    position: Tensor


def camera_from(settings: CameraSettings) -> Camera:
    """Build a camera whose images have the size to which they are resized.

    Resizing stretches both axes on their own, and with them focal length and principal point.

    Raises:
        InputError: on an unknown lens, a wrong number of values, and a lens that draws two directions at one place.
    """
    lengths = {"sensor": 2, "focal": 2, "centre": 2, "image": 2, "position": 3}
    for name, length in lengths.items():
        if len(getattr(settings, name)) != length:
            raise InputError(
                f"needs {length} numbers", f"{_WHERE}.{name}", "see conf/perception/default.yaml"
            )
    if settings.lens not in (PINHOLE, FISHEYE):
        raise InputError(
            f"there is no lens {settings.lens!r}", f"{_WHERE}.lens", f"use {PINHOLE} or {FISHEYE}"
        )
    width, height = (image / sensor for image, sensor in zip(settings.image, settings.sensor, strict=True))
    sine, cosine = math.sin(settings.pitch), math.cos(settings.pitch)
    camera = Camera(
        size=(settings.image[0], settings.image[1]),
        focal=(width * settings.focal[0], height * settings.focal[1]),
        centre=(width * (settings.centre[0] + 0.5) - 0.5, height * (settings.centre[1] + 0.5) - 0.5),
        distortion=tuple(settings.distortion) if settings.lens == FISHEYE else None,
        widest=0.5 * settings.field_of_view,
        axes=torch.tensor([[0.0, -1.0, 0.0], [sine, 0.0, -cosine], [cosine, 0.0, sine]], dtype=torch.float64),
        position=torch.tensor(settings.position, dtype=torch.float64),
    )
    _check(camera)
    return camera


def _check(camera: Camera) -> None:
    if not 0.0 < camera.widest < 0.5 * math.pi:
        raise InputError(
            "is not in front of the camera", f"{_WHERE}.field_of_view", "use less than π, in rad"
        )
    drawn = _drawn_at(camera, torch.linspace(0.0, camera.widest, 1000, dtype=torch.float64))
    if not bool((drawn.diff() > 0).all()):
        raise InputError(
            "draws two directions at one place", f"{_WHERE}.distortion", "use a smaller field_of_view"
        )


def project(camera: Camera, points: Vector) -> Pair:
    """Return the pixels at which points in the camera's frame appear, finite also for those it does not see."""
    across = torch.linalg.vector_norm(points[..., :2], dim=-1)
    angle = torch.atan2(across, points[..., 2]).clamp(max=camera.widest)
    on_axis = across == 0
    stretch = _drawn_at(camera, angle) / torch.where(on_axis, torch.ones_like(across), across)
    return points[..., :2] * stretch[..., None] * points.new_tensor(camera.focal) + points.new_tensor(
        camera.centre
    )


def unproject(camera: Camera, pixels: Pair) -> Vector:
    """Return the direction in which pixels look, as unit vectors in the camera's frame."""
    drawn = (pixels - pixels.new_tensor(camera.centre)) / pixels.new_tensor(camera.focal)
    distance = torch.linalg.vector_norm(drawn, dim=-1)
    angle = _angle_of(camera, distance)
    on_axis = distance == 0
    sideways = drawn / torch.where(on_axis, torch.ones_like(distance), distance)[..., None]
    return torch.cat((sideways * torch.sin(angle)[..., None], torch.cos(angle)[..., None]), dim=-1)


def sees(camera: Camera, points: Vector) -> Tensor:
    """Return whether points in the camera's frame are in front of it and inside its image, (...,) bool."""
    pixels = project(camera, points)
    angle = torch.atan2(torch.linalg.vector_norm(points[..., :2], dim=-1), points[..., 2])
    inside = (pixels >= 0) & (pixels <= pixels.new_tensor(camera.size) - 1)
    return inside.all(-1) & (angle < camera.widest)


def in_camera(camera: Camera, position: Vector, attitude: Quaternion, points: Vector) -> Vector:
    """Return points of the world in the camera's frame, m.

    Args:
        camera: on the machine.
        position: of the machine, world frame, m.
        attitude: of the machine, body to world.
        points: world frame, m.
    """
    on_body = rotations.rotate_inverse(attitude, points - position) - camera.position.to(points)
    return on_body @ camera.axes.to(points).T


def _drawn_at(camera: Camera, angle: Real) -> Real:
    """Return d(θ)."""
    if camera.distortion is None:
        return torch.tan(angle)
    return angle * _polynomial((1.0, *camera.distortion), angle * angle)


def _angle_of(camera: Camera, drawn: Real) -> Real:
    """Return θ of d(θ), by Newton's method for a fisheye; no wider than the lens draws."""
    if camera.distortion is None:
        return torch.atan(drawn)
    slope = tuple((2 * power + 1) * k for power, k in enumerate((1.0, *camera.distortion)))
    angle = drawn.clamp(max=camera.widest)
    for _ in range(_NEWTON_STEPS):
        step = (_drawn_at(camera, angle) - drawn) / _polynomial(slope, angle * angle)
        angle = (angle - step).clamp(0.0, camera.widest)
    return angle


def _polynomial(coefficients: tuple[float, ...], value: Tensor) -> Tensor:
    """Return c₀ + c₁x + c₂x² and so on, by Horner's rule."""
    result = torch.full_like(value, coefficients[-1])
    for coefficient in coefficients[-2::-1]:
        result = result * value + coefficient
    return result
