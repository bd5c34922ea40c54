from dataclasses import replace

import pytest
import torch

from simgap.perception.render import Renderer, unhidden
from simgap.perception.scene import scene_around
from simgap.perception.settings import ImageSettings
from simgap.perception.view import view
from simgap.perception.views import random_views
from tests.pipeline.perception.eyes import course, perception, standing_before
from tests.pipeline.perception.scenes import CLEAN, at, dark, gates_at, small, standing


def taken(camera, track, motion, settings: ImageSettings = CLEAN, seed: int = 0) -> torch.Tensor:
    """Return one image, (height, width)."""
    random = torch.Generator().manual_seed(seed)
    return Renderer(camera, settings).images(dark(track, motion, settings), motion, random)[0, 0]


def opening_around(image: torch.Tensor, x: int, y: int) -> torch.Tensor:
    """Return how many dark pixels there are from a place to the left, the right, upwards and downwards, px."""
    ways = (image[y, :x].flip(0), image[y, x:], image[:y, x].flip(0), image[y:, x])
    ends = [int((way > 0.9).nonzero()[0]) for way in ways]
    return torch.stack([(1.0 - way[: end + 1]).sum() for way, end in zip(ways, ends, strict=True)])


@pytest.mark.parametrize("lens", ["fisheye", "pinhole"])
@pytest.mark.parametrize("distance", [2.0, 4.0])
@pytest.mark.parametrize("aside", [0.0, 0.3])
def test_the_edges_of_an_opening_are_where_the_camera_projects_them(lens, distance, aside):
    """Where the opening begins on lines through a pixel inside it, beside the projected edges."""
    camera = small(lens)
    track, pitch = gates_at([distance]), 0.35 if lens == "fisheye" else 0.0
    motion = at([0.0, aside, 2.0], pitch=pitch)
    image = taken(camera, track, motion)
    seen = view(camera, track, motion.position, motion.attitude)
    assert bool(seen.visible.all())
    left_up, right_up, right_down, left_down = seen.corners[0, 0]
    x, y = (round(float(part)) for part in seen.corners[0, 0].mean(0))
    found = torch.tensor([x - 0.5, x - 0.5, y - 0.5, y - 0.5]) + torch.tensor(
        [-1.0, 1.0, -1.0, 1.0]
    ) * opening_around(image, x, y)
    # An edge across the line of sight bends in a fisheye by less than this.
    wanted = torch.stack(
        [
            crossing(left_up, left_down, 1, y),
            crossing(right_up, right_down, 1, y),
            crossing(left_up, right_up, 0, x),
            crossing(left_down, right_down, 0, x),
        ]
    )
    limit = 0.2 if lens == "pinhole" else 1.0
    assert float((found - wanted).abs().max()) < limit


def crossing(first: torch.Tensor, second: torch.Tensor, axis: int, place: float) -> torch.Tensor:
    """Return the other coordinate at which the line through two points has a given one."""
    share = (place - first[axis]) / (second[axis] - first[axis])
    return (first + share * (second - first))[1 - axis]


@pytest.mark.parametrize("gate", [0, 4])
@pytest.mark.parametrize("metres", [3.0, -5.0])
def test_an_opening_has_the_middle_of_its_corners(gate, metres):
    """From before and from behind, all else being dark: the middle of the light is that of the frame's outline."""
    track = course()
    alone = replace(track, centres=track.centres[[gate]], axes=track.axes[[gate]])
    motion = standing(standing_before(track, gate, metres, across=0.5))
    camera = small("fisheye")
    image = taken(camera, alone, motion)
    wide = replace(alone, opening=alone.opening + 2.0 * alone.frame)
    outline = view(camera, wide, motion.position, motion.attitude)
    assert bool(outline.visible.all())
    low, high = outline.corners[0, 0].min(0).values, outline.corners[0, 0].max(0).values
    y, x = (image > 0.05).nonzero().float().unbind(-1)
    for axis, found in enumerate((x, y)):
        assert float((found.min() - low[axis]).abs()) < 1.0
        assert float((found.max() - high[axis]).abs()) < 1.0


def test_a_nearer_gate_hides_a_farther_one():
    camera, motion = small("pinhole"), at([0.0, 0.0, 2.0])
    track = gates_at([3.0, 2.0])
    # The farther gate's opening lies behind the frame of the nearer one.
    track = replace(track, centres=track.centres + torch.tensor([[0.0, 2.1, 0.0], [0.0, 0.0, 0.0]]))
    scene = dark(track, motion)
    scene = replace(scene, shade=torch.tensor([[0.3, 0.9]]))
    seen = view(camera, track, motion.position, motion.attitude)
    shown = unhidden(scene, motion, camera, seen)[0]
    assert bool(shown[1].all())
    assert shown[0].tolist() == [seen.inside[0, 0, 0].item(), False, False, seen.inside[0, 0, 3].item()]
    image = Renderer(camera, CLEAN).images(scene, motion, torch.Generator())[0, 0]
    for corner in (1, 2):
        x, y = seen.corners[0, 0, corner].round().long().tolist()
        assert float(image[y, x]) == pytest.approx(0.9, abs=0.01)


def test_what_is_gone_through_is_behind():
    assert float(taken(small("fisheye"), gates_at([-3.0]), at([0.0, 0.0, 2.0])).max()) == 0.0


def test_a_blur_is_as_long_as_the_way_within_the_shutter():
    """A gate 2 m away that passes by at 30 m/s for 10 ms moves by 0.3 m: its outline grows by that."""
    camera, track = small("pinhole"), gates_at([2.0])
    many = replace(CLEAN, exposures=64)
    still, fast = (
        taken(camera, track, at([0.0, 0.0, 2.0], (0.0, speed, 0.0)), many) for speed in (0.0, 30.0)
    )
    widths, heights = [], []
    for image in (still, fast):
        y, x = (image > 0.01).nonzero().unbind(-1)
        widths.append(float(x.max() - x.min()))
        heights.append(float(y.max() - y.min()))
    assert widths[1] - widths[0] == pytest.approx(camera.focal[0] * 0.3 / 2.0, abs=1.01)
    assert heights[0] == heights[1]


def test_noise_has_the_deviation_that_is_asked_for():
    bright = replace(CLEAN, read=[0.02, 0.02], shot=[0.05, 0.05], gate=[0.5, 0.5])
    camera, track, motion = (
        small("pinhole"),
        replace(gates_at([1.0]), opening=0.01, frame=5.0),
        at([0.0, 0.0, 2.0]),
    )
    image = taken(camera, track, motion, bright)[:30]
    assert float(image.mean()) == pytest.approx(0.5, abs=0.005)
    assert float(image.std()) == pytest.approx((0.05**2 * 0.5 + 0.02**2) ** 0.5, rel=0.05)


def drawn(device: str, seed: int, settings: ImageSettings) -> torch.Tensor:
    camera, views = small("fisheye"), perception().detector.views
    random = torch.Generator().manual_seed(seed)
    track, motion, ground = random_views(camera, views, 3, random)
    scene = scene_around(track, motion.position, ground, settings, random)
    scene, motion = (
        type(each)(**{name: part.to(device) for name, part in vars(each).items()}) for each in (scene, motion)
    )
    return (
        Renderer(camera, settings, device)
        .images(scene, motion, torch.Generator(device).manual_seed(seed))
        .cpu()
    )


def test_a_seed_gives_the_same_images_again_and_another_one_others():
    settings = perception().images
    first, again, other = (drawn("cpu", seed, settings) for seed in (5, 5, 6))
    assert torch.equal(first, again)
    assert not torch.equal(first, other)
    assert float(first.min()) >= 0.0
    assert float(first.max()) <= 1.0


@pytest.mark.skipif(not torch.cuda.is_available(), reason="needs a GPU")
def test_a_gpu_draws_what_a_cpu_does():
    """Pixels at an edge may differ by one of the instants, and all by a level."""
    settings = replace(CLEAN, clutter=5, covers=1)
    apart = (drawn("cuda", 5, settings) - drawn("cpu", 5, settings)).abs()
    assert float((apart > 1.5 / 255.0).float().mean()) < 1e-3
