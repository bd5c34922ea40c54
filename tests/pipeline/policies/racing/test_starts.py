from dataclasses import replace

import pytest
import torch

from simgap.errors import InputError
from simgap.physics import rotations
from simgap.policies.racing.flying import PARTS
from simgap.policies.racing.passage import passage
from simgap.policies.racing.settings import Starts
from simgap.policies.racing.starts import drawn_start, first_starts, keep, perturbed
from tests.pipeline.gates.tracks import track_named

SETTINGS = Starts(kept=8)
GATES = torch.arange(4).repeat(500)  # of the tiny track


def test_before_any_pass_a_machine_starts_in_a_gate_and_flies_out_of_it():
    track = track_named("split_s")
    starts = first_starts(track, SETTINGS)
    assert starts.shape == (7, 8, 13)
    torch.testing.assert_close(starts[:, 3, PARTS["position"]], track.centres)
    ahead = rotations.rotate(starts[:, 0, PARTS["attitude"]], torch.tensor([1.0, 0.0, 0.0]).expand(7, 3))
    torch.testing.assert_close(ahead, track.axes[:, 0], rtol=0.0, atol=1e-5)
    torch.testing.assert_close(starts[:, 0, PARTS["velocity"]], SETTINGS.speed * track.axes[:, 0])


def test_a_perturbation_stays_within_its_bounds_and_a_quaternion_a_unit():
    track = track_named("tiny")
    state = first_starts(track, SETTINGS)[:, 0].repeat(500, 1)
    moved = perturbed(state, GATES, track, SETTINGS, torch.Generator().manual_seed(0))
    difference = moved - state
    for name in ("position", "velocity", "body_rate"):
        bound = getattr(SETTINGS, name)
        size = float(difference[:, PARTS[name]].abs().max())
        assert 0.95 * bound < size <= bound + 1e-6
    angle = rotations.rotation_angle(state[:, PARTS["attitude"]], moved[:, PARTS["attitude"]])
    assert 0.0 < float(angle.max()) <= SETTINGS.attitude * 3**0.5 + 1e-4
    torch.testing.assert_close(moved[:, PARTS["attitude"]].norm(dim=-1), torch.ones(2000))


@pytest.mark.parametrize("name", ["tiny", "figure_eight", "split_s"])
def test_no_machine_starts_before_the_gate_that_it_has_passed(name):
    track = track_named(name)
    gates = torch.arange(len(track)).repeat(500)
    state = first_starts(track, SETTINGS)[gates, 0]
    moved = perturbed(state, gates, track, SETTINGS, torch.Generator().manual_seed(0))[:, PARTS["position"]]
    ahead = ((moved - track.centres[gates]) * track.axes[gates, 0]).sum(-1)
    assert float(ahead.min()) > -1e-5
    # Straight on nobody hits the frame that is behind.
    further = moved + 0.3 * state[:, PARTS["velocity"]]
    assert not bool(passage(track, moved, further, (gates + 1) % len(track)).hit.any())


def test_seen_states_take_the_place_of_earlier_ones_of_their_gate():
    starts = torch.zeros(3, 8, 13)
    seen = torch.arange(1.0, 7.0)[:, None].expand(6, 13)
    keep(starts, torch.tensor([1, 1, 1, 1, 2, 2]), seen, SETTINGS, torch.Generator().manual_seed(0))
    assert not bool(starts[0].any())
    assert set(starts[1, :, 0].tolist()) <= {0.0, 1.0, 2.0, 3.0, 4.0}
    assert set(starts[2, :, 0].tolist()) <= {0.0, 5.0, 6.0}
    assert 6.0 in starts[2, :, 0]


def test_gates_are_drawn_evenly_and_by_the_seed():
    track = track_named("tiny")
    starts = first_starts(track, SETTINGS)
    gates, states = drawn_start(starts, 4000, track, SETTINGS, torch.Generator().manual_seed(0))
    again = drawn_start(starts, 4000, track, SETTINGS, torch.Generator().manual_seed(0))
    assert torch.equal(gates, again[0])
    assert torch.equal(states, again[1])
    assert bool((torch.bincount(gates) > 850).all())


@pytest.mark.parametrize(("planned", "staying"), [(0.0, 2), (0.5, 6)])
def test_a_share_of_the_starts_stays_slow_or_as_planned(planned, staying):
    starts, random = torch.zeros(1, 8, 13), torch.Generator().manual_seed(0)
    for _ in range(20):
        settings = replace(SETTINGS, planned=planned)
        keep(starts, torch.zeros(10, dtype=torch.int64), torch.ones(10, 13), settings, random)
    assert starts[0, :, 0].tolist() == [0.0] * staying + [1.0] * (8 - staying)


def test_planned_states_take_their_share_in_turn():
    planned = torch.arange(1.0, 15.0).reshape(7, 2, 1).expand(7, 2, 13)
    starts = first_starts(track_named("split_s"), replace(SETTINGS, planned=0.375), planned)
    unplanned = first_starts(track_named("split_s"), SETTINGS)
    assert starts[0, 2:5, 0].tolist() == [1.0, 2.0, 1.0]
    assert starts[6, 2:5, 0].tolist() == [13.0, 14.0, 13.0]
    torch.testing.assert_close(starts[:, [0, 1, 5, 6, 7]], unplanned[:, :5])


@pytest.mark.parametrize(("slow", "planned"), [(1.0, 0.0), (0.5, 0.5), (-0.5, 0.0), (0.5, -0.5)])
def test_some_starts_are_left_to_what_is_seen(slow, planned):
    with pytest.raises(InputError, match="leave no place for states that are seen later"):
        first_starts(track_named("tiny"), replace(SETTINGS, slow=slow, planned=planned))
