import torch

from simgap.physics import rotations
from simgap.policies.racing.observation import POLICY_SIZE, PRIVILEGED_SIZE, racing_observation
from tests.pipeline.gates.tracks import track_named


def some_state(batch: int) -> dict[str, torch.Tensor]:
    random = torch.Generator().manual_seed(0)
    draw = [torch.randn(batch, 3, generator=random) for _ in range(4)]
    return {
        "position": draw[0],
        "velocity": draw[1],
        "body_rate": draw[2],
        "attitude": rotations.from_rotation_vector(draw[3]),
    }


def test_the_policy_sees_31_numbers_from_which_the_next_gate_can_be_found():
    track, state, target = track_named("split_s"), some_state(5), torch.tensor([0, 1, 2, 5, 6])
    previous = torch.rand(5, 4)
    seen = racing_observation(track, state, state, torch.zeros(5, 3), target, previous)
    assert seen.policy.shape == (5, POLICY_SIZE) == (5, 31)
    assert seen.privileged.shape == (5, PRIVILEGED_SIZE)
    position, _, turn, corners, action = seen.policy.split([3, 3, 9, 12, 4], dim=1)
    found = 10.0 * corners.reshape(5, 4, 3) @ turn.reshape(5, 3, 3).mT + 10.0 * position[:, None]
    torch.testing.assert_close(found, track.corners[target], rtol=1e-4, atol=1e-4)
    torch.testing.assert_close(action, previous)


def test_the_critic_sees_the_gate_after_the_last_one_at_the_start():
    track, state = track_named("tiny"), some_state(2)
    last, first = torch.tensor([3, 3]), torch.tensor([0, 0])
    beyond = racing_observation(track, state, state, torch.zeros(2, 3), last, torch.zeros(2, 4)).privileged[
        :, 6:
    ]
    next_ = racing_observation(track, state, state, torch.zeros(2, 3), first, torch.zeros(2, 4)).policy[
        :, 15:27
    ]
    assert torch.equal(beyond, next_)


def test_corners_turn_with_the_body():
    track, state, target = track_named("tiny"), some_state(3), torch.tensor([1, 1, 1])
    nothing = (torch.zeros(3, 3), target, torch.zeros(3, 4))
    seen = racing_observation(track, state, state, *nothing).policy[:, 15:27].reshape(3, 4, 3)
    turn = rotations.from_rotation_vector(torch.tensor([[0.0, 0.0, 0.5]]).expand(3, 3))
    turned = {**state, "attitude": rotations.multiply(state["attitude"], turn)}
    again = racing_observation(track, turned, turned, *nothing).policy[:, 15:27].reshape(3, 4, 3)
    torch.testing.assert_close(rotations.rotate(turn[:, None], again), seen, rtol=1e-4, atol=1e-4)
