import pytest
import torch

from simgap.errors import InputError
from simgap.physics import rotations
from simgap.simulation.flight import racing_flight
from simgap.simulation.knn_residual import NearestNeighbours, residual_features
from tests.pipeline.platforms.machines import QUADROTOR
from tests.pipeline.simulation.test_flight import actions, flown, level, tumbling


def drawn(*shape: int, seed: int = 0, dtype: torch.dtype = torch.float64) -> torch.Tensor:
    return torch.randn(*shape, generator=torch.Generator().manual_seed(seed), dtype=torch.float64).to(dtype)


def test_the_neighbours_are_those_of_a_search_one_by_one():
    inputs, outputs, queries = drawn(200, 3), drawn(200, 2, seed=1), drawn(1100, 3, seed=2)
    inputs[:, 1] *= 100.0  # a feature in other units
    queries[:, 1] *= 100.0
    found = NearestNeighbours(inputs, outputs)(queries)
    size = inputs.std(0)
    for index in range(0, 1100, 109):
        distance = ((inputs - queries[index]) / size).square().sum(1)
        nearest = sorted(range(200), key=lambda sample: float(distance[sample]))[:5]
        torch.testing.assert_close(found[index], outputs[nearest].mean(0))


def test_at_a_sample_its_own_output_is_found():
    inputs, outputs = drawn(50, 4), drawn(50, 3, seed=1)
    torch.testing.assert_close(NearestNeighbours(inputs, outputs, count=1)(inputs), outputs)


def test_the_order_of_the_samples_does_not_matter():
    inputs, outputs, queries = drawn(80, 3), drawn(80, 2, seed=1), drawn(30, 3, seed=2)
    order = torch.randperm(80, generator=torch.Generator().manual_seed(3))
    shuffled = NearestNeighbours(inputs[order], outputs[order])(queries)
    torch.testing.assert_close(shuffled, NearestNeighbours(inputs, outputs)(queries))


def test_in_single_precision_far_from_the_origin():
    inputs, outputs = drawn(300, 3) + 50.0, drawn(300, 2, seed=1)
    queries = drawn(40, 3, seed=2) + 50.0
    single = NearestNeighbours(inputs.float(), outputs.float())(queries.float())
    torch.testing.assert_close(
        single.double(), NearestNeighbours(inputs, outputs)(queries), atol=1e-5, rtol=1e-5
    )


def test_the_gradient_of_the_outputs_is_their_share():
    inputs, outputs = drawn(60, 3), drawn(60, 2, seed=1).requires_grad_()
    NearestNeighbours(inputs, outputs)(drawn(1, 3, seed=2)).sum().backward()
    assert sorted(outputs.grad[:, 0].tolist())[-6:] == pytest.approx([0.0, 0.2, 0.2, 0.2, 0.2, 0.2])


def test_a_residual_that_is_the_same_everywhere_acts_as_that_force():
    push = torch.tensor([0.0, 0.0, 2.0, 0.0, 0.0, 0.0], dtype=torch.float64)
    everywhere = NearestNeighbours(drawn(20, 7), push.expand(20, 6))
    action = torch.tensor([[9.81, 0.0, 0.0, 0.0]], dtype=torch.float64)
    pushed = flown(racing_flight(QUADROTOR, residual=everywhere), level(1), action, 20)
    alone = flown(racing_flight(QUADROTOR), level(1), action, 20)
    assert float(pushed[0, 9] - alone[0, 9]) == pytest.approx(2.0 * 0.2, rel=1e-9)
    assert float(pushed[0, 2] - alone[0, 2]) == pytest.approx(0.5 * 2.0 * 0.2**2, rel=1e-9)


def test_the_residual_is_looked_up_at_the_start_of_a_period_and_held():
    flight = racing_flight(QUADROTOR, residual=NearestNeighbours(drawn(100, 7), drawn(100, 6, seed=1)))
    state, action = tumbling(3, seed=4), actions(3, seed=5)
    velocity = rotations.rotate_inverse(state[:, 3:7], state[:, 7:10])
    features = residual_features(velocity, state[:, 10:13], action)
    expected = torch.cat([action, flight.residual(features)], dim=1)
    torch.testing.assert_close(flight.acting(state, action), expected)
    held, memory = state, None
    for _ in range(flight.substeps):
        held, memory = flight.inner_step(held, expected, memory)
    torch.testing.assert_close(flight.step(state, action)[0], held)


def test_samples_that_say_nothing_are_refused():
    with pytest.raises(InputError, match="too few"):
        NearestNeighbours(drawn(4, 7), drawn(4, 6))
    with pytest.raises(InputError, match="never changes"):
        NearestNeighbours(torch.ones(10, 2).double(), drawn(10, 6))
