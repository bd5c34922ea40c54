"""The chain in the loop: images of machines in flight, and what is left of the drift of their odometry."""

from dataclasses import replace

import numpy as np
import pytest
import torch

from benchmarks.perception import Flight, flown, states_of
from simgap.perception.camera import camera_from
from simgap.perception.chain import Chain
from simgap.perception.view import view
from tests.pipeline.perception.eyes import course, perception

STEP = 0.01  # s
EVERY = 4  # steps from image to image
SURE = replace(
    perception(), corners=replace(perception().corners, noise=1e-6, tilt=1e-7)
)  # of corners that are exact


def exact(track, settings):
    """Return a detector that makes no mistake."""
    camera = camera_from(settings.camera)

    def see(states):
        position, attitude = torch.from_numpy(states[:, :3]), torch.from_numpy(states[:, 6:10])
        seen = view(camera, track, position, attitude)
        return [corners[shown].numpy() for corners, shown in zip(seen.corners, seen.visible, strict=True)]

    return see


def states_behind(flight: Flight, machines: int) -> np.ndarray:
    """Return states of machines that fly the same line, each a second behind the next, (steps, machines, 13)."""
    states, late = states_of(flight), round(1.0 / STEP)
    steps = len(states) - machines * late
    return np.stack([states[late * number :][:steps] for number in range(machines)], axis=1)


def drifting(states: np.ndarray, velocity: float) -> np.ndarray:
    """Return what odometry believes that misjudges velocity along x, m/s, by as many times as the machine's number."""
    wrong = velocity * np.arange(1, states.shape[1] + 1)
    believed = states.copy()
    believed[..., 3] += wrong
    believed[..., 0] += STEP * np.arange(1, len(states) + 1)[:, None] * wrong
    return believed


def flown_by(chain: Chain, states: np.ndarray, believed: np.ndarray) -> np.ndarray:
    return np.stack([chain.corrected(*now) for now in zip(states, believed, strict=True)])


def chained(settings, steps=200, machines=2, drift=0.5, seed=0, every=EVERY):
    """Return true states, what the chain makes of the odometry, and the chain."""
    track = course()
    settings = replace(settings, images=replace(settings.images, period=every * STEP))
    states = states_behind(flown(track, laps=1), machines)[:steps]
    chain = Chain(exact(track, settings), settings, track, machines, STEP, seed)
    return states, flown_by(chain, states, drifting(states, drift)), chain


def test_exact_corners_give_the_exact_position_at_every_image():
    states, corrected, chain = chained(SURE)
    assert bool(chain.in_view.all())
    np.testing.assert_allclose(corrected[::EVERY, :, :3], states[::EVERY, :, :3], rtol=0, atol=1e-5)
    np.testing.assert_array_equal(corrected[..., 6:], states[..., 6:])


def test_a_drift_that_grows_evenly_is_known_between_images_too_where_no_other_is_expected():
    even = replace(SURE, drift=replace(SURE.drift, position=1e-9, velocity=1e-3, taken=1.0))
    states, corrected, _ = chained(even, steps=60)
    np.testing.assert_allclose(corrected[40:, :, :6], states[40:, :, :6], rtol=0, atol=1e-3)


def test_without_gates_odometry_stands():
    settings, track = perception(), course()
    states = states_behind(flown(track, laps=1), 2)[:50]
    believed = drifting(states, 0.5)
    chain = Chain(lambda now: [np.zeros((0, 4, 2))] * len(now), settings, track, 2, STEP, seed=0)
    np.testing.assert_array_equal(flown_by(chain, states, believed), believed)
    assert not chain.in_view.any()
    assert {name: count.tolist() for name, count in chain.counts.items()} == {
        "images": [13, 13],
        "gates_found": [0, 0],
        "gates_believed": [0, 0],
    }


def test_what_is_found_is_known_only_when_the_detector_is_done():
    late = replace(SURE, detector=replace(SURE.detector, delay=0.03))
    states, corrected, chain = chained(late, steps=8, every=100)
    wrong = np.abs(corrected - states)[:, 0, 0]
    assert wrong[:3] == pytest.approx([0.005, 0.01, 0.015])  # as the odometry has it
    # What the drift was at the image is taken off; the odometry goes on for three more steps.
    assert wrong[3] == pytest.approx(0.015, abs=1e-4)
    assert chain.counts["images"].tolist() == [1, 1]


def test_the_same_seed_gives_the_same_estimates():
    once, again, other = (chained(perception(), steps=60, seed=seed)[1] for seed in (3, 3, 4))
    np.testing.assert_array_equal(once, again)
    assert not np.array_equal(once, other)


def test_a_machine_is_corrected_by_its_own_image():
    """Two machines together are as each of them alone, but for the perturbed corners."""
    states, both, _ = chained(SURE, steps=40)
    assert not np.allclose(states[:, 0], states[:, 1])
    np.testing.assert_allclose(both[-4, :, :3], states[-4, :, :3], rtol=0, atol=1e-5)
