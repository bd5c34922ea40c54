from dataclasses import replace

import numpy as np
import pytest
import torch

from simgap.perception.view import distances, view
from simgap.physics import rotations
from tests.pipeline.perception.eyes import corners_of, course, fisheye, standing_before


def test_a_gate_ahead_is_seen_and_one_behind_is_not():
    camera, track = fisheye(), course()
    machine = standing_before(track, 1, 5.0)
    half_a_turn = rotations.from_rotation_vector(torch.tensor([0.0, 0.0, np.pi], dtype=torch.float64))
    away = rotations.multiply(torch.from_numpy(machine.attitude), half_a_turn).numpy()
    assert 1 in corners_of(camera, track, machine)
    assert 1 not in corners_of(camera, track, replace(machine, attitude=away))


@pytest.mark.parametrize("metres", [5.0, -5.0])
def test_corners_are_named_as_they_are_seen_from_either_side(metres):
    camera, track = fisheye(), course()
    corners = corners_of(camera, track, standing_before(track, 1, metres))
    left_up, right_up, right_down, left_down = corners[1]
    assert left_up[0] < right_up[0]
    assert left_down[0] < right_down[0]
    assert left_up[1] < left_down[1]
    assert right_up[1] < right_down[1]


def test_a_gate_that_leaves_the_image_is_not_in_view():
    camera, track = fisheye(), course()
    assert 1 in corners_of(camera, track, standing_before(track, 1, 2.0))
    assert 1 not in corners_of(camera, track, standing_before(track, 1, 0.2))


def test_gates_in_view_have_a_distance_and_others_do_not():
    camera, track = fisheye(), course()
    machine = standing_before(track, 1, 5.0)
    away = distances(camera, track, torch.tensor(machine.position), torch.tensor(machine.attitude))
    assert float(away[1]) == pytest.approx(5.0)
    assert torch.isfinite(away).nonzero().flatten().tolist() == [*corners_of(camera, track, machine)]


def test_a_batch_sees_what_its_machines_see():
    camera, track = fisheye(), course()
    machines = [standing_before(track, gate, 6.0, 1.0) for gate in range(len(track))]
    position = torch.tensor(np.stack([machine.position for machine in machines]))
    attitude = torch.tensor(np.stack([machine.attitude for machine in machines]))
    whole = view(camera, track, position, attitude)
    assert whole.corners.shape == (7, 7, 4, 2)
    for index in range(len(machines)):
        alone = view(camera, track, position[index], attitude[index])
        torch.testing.assert_close(whole.corners[index], alone.corners)
        assert torch.equal(whole.visible[index], alone.visible)
