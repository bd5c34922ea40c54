from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from simgap.perception.camera import unproject
from simgap.perception.pose import Fix, fixes_from, middles_seen, positions_from
from simgap.perception.settings import CornerSettings
from simgap.physics import rotations
from tests.pipeline.perception.eyes import corners_of, course, fisheye, standing_before

CAMERA, TRACK = fisheye(position=[0.1, 0.02, -0.03]), course()
EXACT = CornerSettings(noise=0.0, tilt=0.0)


def fixes(corners: np.ndarray, belief, corner_settings: CornerSettings = EXACT, seed: int = 0) -> list[Fix]:
    return fixes_from(CAMERA, TRACK, corners, belief, corner_settings, np.random.default_rng(seed))


def errors(machine, gate: int, noise: float, tilt: float, count: int) -> np.ndarray:
    """Return by how much repeated measurements are off, (count, 3) m."""
    random = np.random.default_rng(1)
    pixels = corners_of(CAMERA, TRACK, machine)[gate] + noise * random.standard_normal((count, 4, 2))
    middles = middles_seen(unproject(CAMERA, torch.from_numpy(pixels)).numpy(), TRACK.opening)
    turns = rotations.from_rotation_vector(torch.from_numpy(tilt * random.standard_normal((count, 3))))
    attitudes = rotations.multiply(torch.from_numpy(machine.attitude).expand_as(turns), turns).numpy()
    return positions_from(CAMERA, TRACK, gate, middles, attitudes) - machine.position


def size_of(errors: np.ndarray) -> float:
    """Return the median length of errors, m."""
    return float(np.median(np.linalg.norm(errors, axis=-1)))


@settings(max_examples=50)
@given(
    gate=st.integers(0, 6),
    metres=st.floats(1.5, 12.0),
    behind=st.booleans(),
    across=st.floats(-1.0, 1.0),
    turned=st.floats(-0.3, 0.3),
)
def test_exact_corners_give_the_exact_position(gate, metres, behind, across, turned):
    machine = standing_before(TRACK, gate, -metres if behind else metres, across, turned)
    corners = corners_of(CAMERA, TRACK, machine)
    found = fixes(np.array([*corners.values()]).reshape(-1, 4, 2), machine)
    assert [fix.gate for fix in found] == [*corners]
    for fix in found:
        np.testing.assert_allclose(fix.position, machine.position, atol=1e-5)


def test_the_error_falls_with_the_noise_of_the_corners():
    machine = standing_before(TRACK, 1, 5.0, across=1.0)
    sizes = [size_of(errors(machine, 1, noise, 0.0, 300)) for noise in (2.0, 1.0, 0.5, 0.25)]
    assert all(less < 0.7 * more for more, less in pairwise(sizes))


def test_a_tilt_puts_the_machine_off_by_so_much_of_the_distance():
    tilted = errors(standing_before(TRACK, 1, 8.0), 1, 0.0, 0.01, 2000)
    assert np.std(tilted[:, 2]) == pytest.approx(0.01 * 8.0, rel=0.1)
    assert size_of(errors(standing_before(TRACK, 1, 4.0), 1, 0.0, 0.01, 2000)) < 0.6 * size_of(tilted)


@pytest.mark.parametrize("gate", range(7))
@pytest.mark.parametrize("axis", range(3))
def test_a_gate_is_told_from_the_others_by_an_estimate_that_is_a_metre_off(gate, axis):
    """The nearest two gates of the course are 2.3 m apart."""
    machine = standing_before(TRACK, gate, 4.0)
    off = replace(machine, position=machine.position + np.eye(3)[axis])
    (found,) = fixes(corners_of(CAMERA, TRACK, machine)[gate][None], off)
    assert found.gate == gate
    np.testing.assert_allclose(found.position, machine.position, atol=1e-5)


def test_an_estimate_that_is_far_off_takes_a_gate_for_its_neighbour():
    machine = standing_before(TRACK, 3, 4.0)
    off = replace(machine, position=machine.position - [0.0, 0.0, 2.3])
    (found,) = fixes(corners_of(CAMERA, TRACK, machine)[3][None], off)
    assert found.gate == 4


def test_corners_may_begin_anywhere():
    machine = standing_before(TRACK, 1, 5.0, across=1.0)
    corners = corners_of(CAMERA, TRACK, machine)[1]
    for first in range(4):
        (found,) = fixes(np.roll(corners, first, axis=0)[None], machine)
        np.testing.assert_allclose(found.position, machine.position, atol=1e-5)


def test_the_sampled_covariance_is_the_scatter_of_repeated_measurements():
    machine, noise, tilt = standing_before(TRACK, 1, 4.0, across=1.0), 0.5, 0.01
    scatter = np.cov(errors(machine, 1, noise, tilt, 2000).T)
    corners = corners_of(CAMERA, TRACK, machine)[1][None]
    known = CornerSettings(noise, tilt, 20)
    sampled = [fixes(corners, machine, known, seed)[0].covariance for seed in range(100)]
    ratios = np.linalg.eigvals(np.linalg.solve(scatter, np.mean(sampled, axis=0)))
    assert ratios.min() > 0.7
    assert ratios.max() < 1.4


@pytest.mark.parametrize("corners", [np.full((1, 4, 2), 150.0), np.zeros((0, 4, 2))])
def test_what_is_no_gate_gives_no_position(corners):
    assert fixes(corners, standing_before(TRACK, 0, 4.0)) == []
