from dataclasses import replace

import numpy as np
import pytest
import torch

from simgap.perception.corners import gates_in
from simgap.perception.maps import CHANNELS, targets
from simgap.perception.view import upright, view
from tests.pipeline.perception.eyes import course, fisheye, perception, standing_before

CAMERA, SETTINGS, TRACK = fisheye(), perception().detector, course()


def maps_of(machine, hidden: tuple[tuple[int, int], ...] = ()) -> tuple[torch.Tensor, dict[int, np.ndarray]]:
    """Return the maps that a perfect detector gives, and the corners of the gates that it shows wholly.

    Gates that are seen from the side, with corners within pixels of each other, are left out.
    """
    state = (torch.from_numpy(part)[None].float() for part in (machine.position, machine.attitude))
    seen = view(CAMERA, TRACK, *state)
    sides = (seen.corners - seen.corners.roll(1, -2)).norm(dim=-1)
    shown = seen.inside & (sides > 5.0).all(-1, keepdim=True)
    for gate, corner in hidden:
        shown[0, gate, corner] = False
    whole = {int(gate): seen.corners[0, gate].numpy() for gate in shown[0].all(-1).nonzero()[:, 0]}
    return targets(CAMERA, seen, shown, SETTINGS), whole


def ordered(gates: np.ndarray) -> np.ndarray:
    return gates[np.lexsort(gates[:, 0].T)]


@pytest.mark.parametrize("gate", range(7))
@pytest.mark.parametrize(("metres", "turned"), [(1.5, 0.2), (-3.0, -0.5), (8.0, 1.2)])
def test_gates_come_out_of_the_maps_of_a_perfect_detector(gate, metres, turned):
    """All that are seen, their corners in order, to a hundredth of a pixel."""
    machine = standing_before(TRACK, gate, metres, across=0.3, turned=turned)
    maps, whole = maps_of(machine)
    (found,) = gates_in(maps, CAMERA, SETTINGS)
    found = upright(CAMERA, torch.from_numpy(found), torch.from_numpy(machine.attitude)).numpy()
    assert len(whole) > 0
    np.testing.assert_allclose(ordered(found), ordered(np.stack([*whole.values()])), atol=0.01)


def test_a_gate_that_lacks_a_corner_is_not_found():
    machine = standing_before(TRACK, 0, 4.0)
    maps, whole = maps_of(machine)
    fewer, rest = maps_of(machine, hidden=((0, 2),))
    assert 0 in whole
    assert 0 not in rest
    assert len(gates_in(fewer, CAMERA, SETTINGS)[0]) == len(gates_in(maps, CAMERA, SETTINGS)[0]) - 1


def test_noise_alone_shows_no_gate():
    noise = 0.25 * torch.rand(2, CHANNELS, 384, 384, generator=torch.Generator().manual_seed(0))
    assert [len(found) for found in gates_in(noise, CAMERA, SETTINGS)] == [0, 0]


def test_two_gates_are_told_apart_by_their_edges():
    """Peaks alone would allow corners of one gate with those of another."""
    maps, whole = maps_of(standing_before(TRACK, 4, 6.0))
    assert len(whole) >= 2
    without = maps.clone()
    without[:, 4:] = 0.0
    assert len(gates_in(without, CAMERA, SETTINGS)[0]) == 0
    assert len(gates_in(maps, CAMERA, SETTINGS)[0]) == len(whole)


def test_a_bell_that_is_higher_than_its_neighbours_is_no_corner_below_the_threshold():
    maps, whole = maps_of(standing_before(TRACK, 0, 4.0))
    strict = replace(SETTINGS, least_peak=1.1)
    assert len(gates_in(maps, CAMERA, SETTINGS)[0]) == len(whole)
    assert len(gates_in(maps, CAMERA, strict)[0]) == 0
