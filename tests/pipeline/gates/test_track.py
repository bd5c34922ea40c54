import pytest
import torch

from simgap.errors import InputError
from simgap.gates.settings import GateSettings, TrackSettings
from simgap.gates.track import track_from
from tests.pipeline.gates.tracks import CONF, track_named

BOX = [[-5.0, -5.0, 0.0], [5.0, 5.0, 5.0]]


def two_gates(**changed) -> TrackSettings:
    gates = [GateSettings([0.0, 0.0, 2.0], [2.0, 0.0]), GateSettings([3.0, 0.0, 2.0], [0.0, -1.0])]
    return TrackSettings(**{"name": "two", "gates": gates, "box": BOX} | changed)


@pytest.mark.parametrize("name", sorted(path.stem for path in (CONF / "track").glob("*.yaml")))
def test_a_track_of_the_project_leads_through_every_gate_in_its_direction(name):
    track = track_named(name)
    to = track.centres - track.centres.roll(1, 0)
    on = track.centres.roll(-1, 0) - track.centres
    along = to / to.norm(dim=-1, keepdim=True) + on / on.norm(dim=-1, keepdim=True)
    turning_back = along.norm(dim=-1) < 0.5  # as in half a loop, where the way says nothing
    assert bool((((along * track.axes[:, 0]).sum(-1) > 0) | turning_back).all())
    assert float(track.corners[..., 2].min()) > 0.0


def test_the_courses_have_the_gates_that_they_are_known_for():
    assert [len(track_named(name)) for name in ("split_s", "figure_eight", "tiny")] == [7, 6, 4]


def test_corners_go_round_the_opening_as_one_flies_at_it():
    corners = track_from(two_gates()).corners
    half = 0.75
    first = torch.tensor([[0, half, half], [0, -half, half], [0, -half, -half], [0, half, -half]])
    torch.testing.assert_close(corners[0], first + torch.tensor([0.0, 0.0, 2.0]))
    torch.testing.assert_close(corners[1, 0], torch.tensor([3.0 + half, 0.0, 2.0 + half]))


def test_the_length_of_a_lap_is_that_of_straight_lines():
    assert track_from(two_gates()).length == pytest.approx(6.0)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"gates": [GateSettings([0.0, 0.0, 2.0], [1.0, 0.0])]}, "fewer than two"),
        ({"clearance": 0.8}, "no room"),
        ({"box": [[0.0, 0.0]]}, "box"),
        ({"box": [[1.0, -5.0, 0.0], [5.0, 5.0, 5.0]]}, "gate 1: is outside"),
        ({"gates": [GateSettings([0.0, 0.0, 2.0], [0.0, 0.0])] * 2}, "direction"),
        ({"gates": [GateSettings([0.0, 0.0], [1.0, 0.0])] * 2}, "position"),
    ],
)
def test_a_track_that_cannot_be_flown_is_refused(changed, message):
    with pytest.raises(InputError, match=message):
        track_from(two_gates(**changed))
