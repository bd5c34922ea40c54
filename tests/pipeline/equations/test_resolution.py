"""What the sensors resolve: steps of an encoder, rest on them, and what friction makes of that."""

import numpy as np
import pandas as pd
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from simgap.equations.encoder import encoder_step
from simgap.equations.resolution import resolution_of, with_resolution
from simgap.platforms import Joint
from simgap.recordings.recording import Recording
from simgap.simulation import Simulator
from simgap.simulation.blocks import Blocks, cut_blocks

TIME_STEP = 0.01
JOINT = Simulator(Joint(inertia=0.01))


def wandering(seed: int, samples: int = 4000) -> np.ndarray:
    """Return a position in rad that moves, slows down and rests in turn."""
    random = np.random.default_rng(seed)
    speed = np.repeat(random.choice([0.0, 0.02, 0.2, 1.0], samples // 50) * random.choice([-1, 1]), 50)
    return random.uniform(-1.0, 1.0) + np.cumsum(speed) * TIME_STEP


def in_blocks(position: np.ndarray) -> torch.Tensor:
    return torch.from_numpy(position).reshape(-1, 200)


@given(st.floats(1e-3, 1e-2), st.integers(0, 100), st.floats(-10.0, 10.0))
def test_the_step_of_an_encoder_is_found_whatever_its_size_and_zero(step, seed, zero):
    levels = zero + step * np.round(wandering(seed) / step)
    assert encoder_step(in_blocks(levels)) == pytest.approx(step, rel=1e-6)


@given(st.floats(1e-3, 1e-2), st.integers(0, 100))
def test_samples_between_two_levels_do_not_hide_them(step, seed):
    levels = step * np.round(wandering(seed) / step)
    places = np.arange(0.0, len(levels) - 401.0, 0.97)[:3600]
    between = np.interp(places, np.arange(len(levels)), levels)
    assert encoder_step(in_blocks(between)) == pytest.approx(step, rel=1e-6)


@given(st.integers(0, 1000))
def test_an_axis_that_rests_at_places_of_a_fine_sensor_has_no_steps(seed):
    random = np.random.default_rng(seed)
    places = np.repeat(random.uniform(-1.0, 1.0, 400), 10)
    assert encoder_step(in_blocks(places)) == 0.0


def test_an_axis_that_never_rests_has_no_steps():
    assert encoder_step(in_blocks(np.sin(np.linspace(0.0, 9.0, 4000)))) == 0.0


def dithering(step: float = 0.0015) -> Blocks:
    """Return an axis that rests on the edge between two steps of its encoder from the third to the fourth second."""
    t = np.arange(0.0, 8.0, TIME_STEP)
    path = np.where(t < 2.0, 0.5 * np.sin(np.pi * t), 0.0) + np.where(t < 4.0, 0.0, 0.02 * np.sin(2.0 * t))
    edge = np.where((t >= 2.0) & (t < 4.0), np.round(0.5 + 0.5 * np.sin(9.0 * t)) * step, 0.0)
    position = step * np.round(path / step) + edge
    frame = pd.DataFrame(
        {"run": "a", "t": t, "segment": 0, "filled": 0, "position": position, "effort": np.sin(t)}
    )
    frame["velocity"] = np.gradient(position, TIME_STEP)
    units = {"position": "rad", "velocity": "rad/s", "effort": "N·m"}
    return cut_blocks(Recording(frame, "joint", units, cleaned=True), JOINT.platform, 1.0, 0.1, held=False)


def test_an_axis_on_the_edge_between_two_steps_rests_though_it_seems_to_move():
    blocks = dithering()
    known = with_resolution(blocks, JOINT, resolution_of(JOINT, blocks))
    rests, velocity = known.resolution["resting"], known.signals["velocity"]
    assert bool((rests[2:4, 30:90] == 1.0).all())
    assert bool((velocity[2:4, 30:90] != 0.0).any())
    assert bool((rests[0, 30:90] == 0.0).all())


def test_an_axis_without_a_position_is_resolved_by_its_velocity_alone():
    blocks = dithering()
    del blocks.signals["position"]
    known = resolution_of(JOINT, blocks)["sliding_velocity"]
    assert known.step == 0.0
    assert known.velocity > 0.0
