import cv2
import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from simgap.errors import InputError
from simgap.perception.camera import camera_from, in_camera, project, sees, unproject
from simgap.policies.racing.settings import Reward
from tests.pipeline.perception.eyes import fisheye, perception, pinhole_settings

CAMERAS = {"fisheye": fisheye(), "pinhole": camera_from(pinhole_settings())}
LEVEL = torch.tensor([1.0, 0.0, 0.0, 0.0], dtype=torch.float64)

angles = st.floats(0.0, 0.98)
ways = st.floats(-np.pi, np.pi)
lengths = st.floats(0.1, 100.0)


def ray(camera, share: float, way: float) -> torch.Tensor:
    angle = share * camera.widest
    parts = [np.sin(angle) * np.cos(way), np.sin(angle) * np.sin(way), np.cos(angle)]
    return torch.tensor(parts, dtype=torch.float64)


@pytest.mark.parametrize("name", CAMERAS)
@given(share=angles, way=ways, length=lengths)
def test_a_pixel_looks_where_its_point_is(name, share, way, length):
    camera = CAMERAS[name]
    direction = ray(camera, share, way)
    back = unproject(camera, project(camera, length * direction))
    torch.testing.assert_close(back, direction, atol=1e-12, rtol=0.0)


@pytest.mark.parametrize("name", CAMERAS)
def test_single_precision_is_kept_and_enough(name):
    camera = CAMERAS[name]
    direction = ray(camera, 0.7, 1.0).float()
    pixel = project(camera, 5.0 * direction)
    assert pixel.dtype == torch.float32
    torch.testing.assert_close(unproject(camera, pixel), direction, atol=1e-5, rtol=0.0)


def test_the_fisheye_is_that_of_opencv():
    camera, random = CAMERAS["fisheye"], np.random.default_rng(0)
    points = random.uniform([-3, -3, 0.5], [3, 3, 8], (50, 3))
    matrix = np.array(
        [[camera.focal[0], 0, camera.centre[0]], [0, camera.focal[1], camera.centre[1]], [0, 0, 1]]
    )
    zero = np.zeros((3, 1))
    expected, _ = cv2.fisheye.projectPoints(points[:, None], zero, zero, matrix, np.array(camera.distortion))
    np.testing.assert_allclose(project(camera, torch.from_numpy(points)).numpy(), expected[:, 0], atol=1e-9)


def test_a_pinhole_divides_by_the_depth():
    pixel = project(CAMERAS["pinhole"], torch.tensor([1.0, -0.5, 4.0]))
    torch.testing.assert_close(pixel, torch.tensor([319.5 + 400.0 / 4.0, 239.5 - 410.0 / 8.0]))


@pytest.mark.parametrize("place", [[0.0, 0.0, 0.0], [0.1, 0.02, -0.03]])
def test_the_camera_looks_up_from_the_body(place):
    camera = fisheye(pitch=0.35, position=place)
    along = torch.tensor([np.cos(0.35), 0.0, np.sin(0.35)], dtype=torch.float64)
    position = torch.tensor([5.0, 2.0, 1.0], dtype=torch.float64)
    lens = position + torch.tensor(place, dtype=torch.float64)
    left, up = torch.eye(3, dtype=torch.float64)[1:]
    points = in_camera(camera, position, LEVEL, torch.stack((lens + 4.0 * along, lens + 4.0 * along + left)))
    torch.testing.assert_close(points[0], torch.tensor([0.0, 0.0, 4.0], dtype=torch.float64))
    torch.testing.assert_close(project(camera, points[0]), torch.tensor(camera.centre, dtype=torch.float64))
    assert project(camera, points[1])[0] < camera.centre[0]
    assert project(camera, in_camera(camera, position, LEVEL, lens + 4.0 * along + up))[1] < camera.centre[1]


def test_the_reward_looks_along_the_same_axis():
    assert perception().camera.pitch == Reward().camera_pitch


def test_a_resized_image_shows_a_point_at_the_same_share_of_its_sides():
    settings = perception().camera
    small, whole = fisheye(), fisheye(image=settings.sensor)
    point = torch.tensor([0.7, -0.4, 2.0], dtype=torch.float64)
    sizes = [torch.tensor(camera.size, dtype=torch.float64) for camera in (small, whole)]
    shares = [
        (project(camera, point) + 0.5) / size for camera, size in zip((small, whole), sizes, strict=True)
    ]
    torch.testing.assert_close(*shares)


def test_it_sees_what_is_in_front_and_inside_the_image():
    points = torch.tensor(
        [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [3.0, 0.0, 1.0], [0.0, 0.55, 1.0], [0.0, 0.6, 1.0]]
    )
    assert sees(CAMERAS["pinhole"], points).tolist() == [True, False, False, True, False]


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"lens": "mirror"}, r"perception\.camera\.lens: there is no lens 'mirror'; use pinhole or fisheye"),
        ({"focal": [400.0]}, r"perception\.camera\.focal: needs 2 numbers"),
        ({"field_of_view": 3.5}, r"perception\.camera\.field_of_view: is not in front"),
        ({"lens": "fisheye", "distortion": [-0.5]}, r"perception\.camera\.distortion: draws two directions"),
    ],
)
def test_a_camera_that_cannot_be_is_refused(changed, message):
    with pytest.raises(InputError, match=message):
        camera_from(pinhole_settings(**changed))
