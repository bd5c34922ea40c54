import torch
from hypothesis import given
from hypothesis import strategies as st

from simgap.policies.racing.passage import passage
from tests.pipeline.gates.test_track import track_from, two_gates

TRACK = track_from(
    two_gates()
)  # the first gate stands across x at the origin, 2 m up; 1.5 m wide, frame 0.3 m
MARGIN = 0.75


def crossed(start: list[float], end: list[float], target: int = 0):
    found = passage(TRACK, torch.tensor([start]), torch.tensor([end]), torch.tensor([target]))
    return bool(found.passed), bool(found.hit), float(found.margin)


def test_the_middle_of_the_gate_in_its_direction_is_passed():
    passed, hit, margin = crossed([-0.1, 0.0, 2.0], [0.1, 0.0, 2.0])
    assert (passed, hit) == (True, False)
    assert abs(margin - MARGIN) < 1e-6


def test_the_wrong_direction_and_the_wrong_gate_do_not_count():
    assert crossed([0.1, 0.0, 2.0], [-0.1, 0.0, 2.0])[:2] == (False, False)
    assert crossed([-0.1, 0.0, 2.0], [0.1, 0.0, 2.0], target=1)[:2] == (False, False)


def test_the_frame_is_hit_from_either_side_and_whichever_gate_is_next():
    for y in (0.7, -0.85, 1.1):
        for target in (0, 1):
            assert crossed([-0.1, y, 2.0], [0.1, y, 2.0], target)[:2] == (False, True)
            assert crossed([0.1, y, 2.0], [-0.1, y, 2.0], target)[:2] == (False, True)


def test_beside_the_frame_nothing_happens():
    assert crossed([-0.1, 1.3, 2.0], [0.1, 1.3, 2.0])[:2] == (False, False)
    assert crossed([-0.3, 0.0, 2.0], [-0.1, 0.0, 2.0])[:2] == (False, False)


def test_a_gate_is_missed_in_its_direction_beside_its_frame_and_within_reach():
    def missed(y: float, target: int = 0, forward: bool = True) -> bool:
        ends = torch.tensor([[-0.1, y, 2.0]]), torch.tensor([[0.1, y, 2.0]])
        start, end = ends if forward else ends[::-1]
        return bool(passage(TRACK, start, end, torch.tensor([target]), reach=2.0).missed)

    assert [missed(y) for y in (0.0, 1.1, 1.3, 3.1, 3.3)] == [False, False, True, True, False]
    assert not missed(1.3, forward=False)
    assert not missed(1.3, target=1)


@given(
    st.floats(-0.99, 0.99),
    st.floats(-0.99, 0.99),
    st.floats(-1.0, 1.0),
    st.floats(-1.0, 1.0),
    st.floats(0.05, 0.95),
)
def test_the_margin_is_that_of_the_point_where_the_line_meets_the_gate(y, z, dy, dz, share):
    point = torch.tensor([0.0, y, 2.0 + z])
    way = torch.tensor([0.4, dy, dz])
    start, end = point - share * way, point + (1.0 - share) * way
    passed, hit, margin = crossed(start.tolist(), end.tolist())
    expected = MARGIN - max(abs(y), abs(z))
    assert abs(margin - expected) < 1e-5
    if abs(expected - TRACK.clearance) > 1e-4:
        assert passed == (expected > TRACK.clearance)
        assert hit == (expected < TRACK.clearance)


def test_two_steps_through_a_gate_pass_it_once():
    steps = torch.linspace(-1.0, 1.0, 9)[:, None] * torch.tensor([1.0, 0.0, 0.0]) + torch.tensor(
        [0.0, 0.0, 2.0]
    )
    found = passage(TRACK, steps[:-1], steps[1:], torch.zeros(8, dtype=torch.int64))
    assert int(found.passed.sum()) == 1
