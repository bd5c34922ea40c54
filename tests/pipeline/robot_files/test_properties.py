"""What a joint carries does not depend on how the file is written."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from tests.pipeline.robot_files.robots import keys, mjcf, written

SEEDS = st.integers(0, 10**6)
BOX = '<geom type="box" size="0.1 0.05 0.2" mass="1.5"/>'


def quaternion(turn: Rotation) -> str:
    return written(np.roll(turn.as_quat(), 1))


def random_turn(random: np.random.Generator) -> Rotation:
    return Rotation.from_quat(random.normal(size=4))


def read(text: str, folder) -> tuple[float, float, str]:
    """Return inertia, gravity torque and the sentence about its zero."""
    found = keys(text, folder, "j")
    zero = [sentence for sentence in found["assumptions"] if "cos(position)" in sentence]
    return found["inertia"], found.get("gravity_torque", 0.0), "".join(zero)


@settings(max_examples=25)
@given(seed=SEEDS)
def test_frames_between_joint_and_mass_change_nothing(seed, tmp_path_factory):
    """A box given directly, in a frame, in a body in a body, and in a chain of both: one joint, one answer."""
    random, folder = np.random.default_rng(seed), tmp_path_factory.mktemp("nested")
    axis, anchor = random.normal(size=3), random.normal(size=3)
    joint = f'<joint name="j" axis="{written(axis)}" pos="{written(anchor)}"/>'
    first, second = random_turn(random), random_turn(random)
    shift, offset = random.normal(size=3), random.normal(size=3)
    whole, place = first * second, shift + first.apply(offset)
    inner = f'pos="{written(offset)}" quat="{quaternion(second)}"'
    outer = f'pos="{written(shift)}" quat="{quaternion(first)}"'
    at = f'pos="{written(place)}" quat="{quaternion(whole)}"'
    contents = [
        BOX.replace("<geom", f"<geom {at}"),
        f"<frame {at}>{BOX}</frame>",
        f"<frame {outer}><frame {inner}>{BOX}</frame></frame>",
        f"<body {outer}><body {inner}>{BOX}</body></body>",
        f'<body {outer}><joint name="locked"/><frame {inner}><body>{BOX}</body></frame></body>',
    ]
    found = [read(mjcf(f"<body>{joint}{content}</body>"), folder) for content in contents]
    for inertia, gravity, _ in found[1:]:
        assert inertia == pytest.approx(found[0][0], rel=1e-9)
        assert gravity == pytest.approx(found[0][1], rel=1e-6, abs=1e-6)


@settings(max_examples=25)
@given(seed=SEEDS)
def test_a_robot_that_is_turned_about_the_vertical_and_moved_is_the_same(seed, tmp_path_factory):
    random, folder = np.random.default_rng(seed), tmp_path_factory.mktemp("moved")
    joint = (
        f'<joint name="j" axis="{written(random.normal(size=3))}" pos="{written(random.normal(size=3))}"/>'
    )
    box = BOX.replace("<geom", f'<geom pos="{written(random.normal(size=3))}"')
    upright = f"<body>{joint}{box}</body>"
    turned = Rotation.from_rotvec([0.0, 0.0, random.uniform(-3.0, 3.0)])
    moved = f'<body pos="{written(random.normal(size=3))}" quat="{quaternion(turned)}">{joint}{box}</body>'
    one, other = read(mjcf(upright), folder), read(mjcf(moved), folder)
    assert other[:2] == pytest.approx(one[:2], rel=1e-9, abs=1e-9)


@settings(max_examples=25)
@given(seed=SEEDS)
def test_a_body_cut_into_parts_carries_as_much(seed, tmp_path_factory):
    """A box is eight boxes of half the size."""
    random, folder = np.random.default_rng(seed), tmp_path_factory.mktemp("cut")
    half = random.uniform(0.02, 0.3, size=3)
    turn, place = random_turn(random), random.normal(size=3)
    joint = f'<joint name="j" axis="{written(random.normal(size=3))}"/>'
    frame = f'<frame pos="{written(place)}" quat="{quaternion(turn)}">'
    corners = [half / 2 * np.array([x, y, z]) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    parts = "".join(f'<geom type="box" size="{written(half / 2)}" pos="{written(at)}"/>' for at in corners)
    whole = f'<geom type="box" size="{written(half)}"/>'
    one, other = (read(mjcf(f"<body>{joint}{frame}{part}</frame></body>"), folder) for part in (whole, parts))
    assert other[:2] == pytest.approx(one[:2], rel=1e-9, abs=1e-9)


@settings(max_examples=25)
@given(seed=SEEDS)
def test_gravity_is_the_slope_of_the_potential_energy(seed, tmp_path_factory):
    """The sine and cosine parts are those of −d/dq of m·g·height, whatever axis, anchor and reference."""
    random, folder = np.random.default_rng(seed), tmp_path_factory.mktemp("energy")
    axis, anchor, place = random.normal(size=(3, 3))
    reference = random.uniform(-1.0, 1.0)
    joint = f'<joint name="j" axis="{written(axis)}" pos="{written(anchor)}" ref="{reference!r}"/>'
    ball = f'<geom type="sphere" size="0.05" mass="1.5" pos="{written(place)}"/>'
    inertia, sine, said = read(mjcf(f"<body>{joint}{ball}</body>"), folder)
    cosine = float(said.partition("gravity_load.cosine=")[2].partition(",")[0]) if said else 0.0

    def energy(position):
        turn = Rotation.from_rotvec(axis / np.linalg.norm(axis) * (position - reference))
        return 1.5 * 9.81 * (anchor + turn.apply(place - anchor))[2]

    for position in (-2.0, 0.3, 1.1):
        slope = (energy(position + 1e-6) - energy(position - 1e-6)) / 2e-6
        torque = -sine * math.sin(position) - cosine * math.cos(position)
        assert torque == pytest.approx(-slope, abs=1e-3 * 15.0 * np.linalg.norm(place - anchor))
    away = np.cross(axis / np.linalg.norm(axis), place - anchor)
    assert inertia == pytest.approx(1.5 * (away @ away + 0.4 * 0.05**2))
