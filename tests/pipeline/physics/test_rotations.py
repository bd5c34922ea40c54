import hypothesis.extra.numpy as numpy_strategies
import hypothesis.strategies as st
import pytest
import torch
from hypothesis import given
from scipy.spatial.transform import Rotation

from simgap.physics import rotations

COMPONENT = st.floats(-1.0, 1.0, allow_subnormal=False)
ANY_VECTOR = numpy_strategies.arrays(float, (3,), elements=COMPONENT).map(torch.from_numpy)
ANY_ROTATION = (
    numpy_strategies.arrays(float, (4,), elements=COMPONENT)
    .filter(lambda q: (q**2).sum() > 1e-2)
    .map(lambda q: rotations.normalize(torch.from_numpy(q)))
)


def some_rotations(*shape: int, seed: int = 0) -> torch.Tensor:
    generator = torch.Generator().manual_seed(seed)
    return rotations.normalize(torch.randn(*shape, 4, generator=generator, dtype=torch.float64))


def same_rotation(first: torch.Tensor, second: torch.Tensor) -> bool:
    return bool((rotations.rotation_angle(first, second) < 1e-7).all())


@given(ANY_ROTATION, ANY_VECTOR)
def test_rotating_back_undoes_rotating(quaternion, vector):
    torch.testing.assert_close(
        rotations.rotate_inverse(quaternion, rotations.rotate(quaternion, vector)), vector
    )


@given(ANY_ROTATION, ANY_VECTOR)
def test_rotation_agrees_with_its_matrix(quaternion, vector):
    torch.testing.assert_close(rotations.rotate(quaternion, vector), rotations.to_matrix(quaternion) @ vector)


@given(ANY_ROTATION, ANY_ROTATION, ANY_VECTOR)
def test_product_is_one_rotation_after_the_other(left, right, vector):
    torch.testing.assert_close(
        rotations.rotate(rotations.multiply(left, right), vector),
        rotations.rotate(left, rotations.rotate(right, vector)),
    )


@given(ANY_VECTOR, ANY_VECTOR)
def test_a_vector_product_is_perpendicular_to_both(one, other):
    product = rotations.cross(one, other)
    for each in (one, other):
        assert abs(float(rotations.dot(product, each))) < 1e-12
    torch.testing.assert_close(rotations.dot(one, one), (one**2).sum())


@given(ANY_ROTATION)
def test_matrix_round_trip(quaternion):
    assert same_rotation(rotations.from_matrix(rotations.to_matrix(quaternion)), quaternion)


@given(ANY_ROTATION)
def test_rotation_vector_round_trip(quaternion):
    vector = rotations.to_rotation_vector(quaternion)
    assert torch.linalg.vector_norm(vector) <= torch.pi + 1e-9
    assert same_rotation(rotations.from_rotation_vector(vector), quaternion)


def test_convention_is_scalar_first_and_body_to_world():
    quarter_turn_left = rotations.from_rotation_vector(torch.tensor([0.0, 0.0, torch.pi / 2]))
    forward = rotations.rotate(quarter_turn_left, torch.tensor([1.0, 0.0, 0.0]))
    torch.testing.assert_close(forward, torch.tensor([0.0, 1.0, 0.0]), atol=1e-6, rtol=0)
    torch.testing.assert_close(quarter_turn_left[0], torch.cos(torch.tensor(torch.pi / 4)))


def test_matrices_agree_with_scipy():
    quaternions = some_rotations(50)
    expected = Rotation.from_quat(quaternions.numpy(), scalar_first=True).as_matrix()
    torch.testing.assert_close(rotations.to_matrix(quaternions), torch.from_numpy(expected))


def test_half_turns_survive_the_matrix():
    half_turns = torch.cat((torch.zeros(3, 1), torch.eye(3)), dim=1).double()
    assert same_rotation(rotations.from_matrix(rotations.to_matrix(half_turns)), half_turns)


def test_derivative_is_that_of_a_steady_turn():
    start, rate = some_rotations(), torch.tensor([0.3, -2.0, 1.1], dtype=torch.float64)

    def attitude(t: torch.Tensor) -> torch.Tensor:
        return rotations.multiply(start, rotations.from_rotation_vector(rate * t))

    expected = torch.autograd.functional.jacobian(attitude, torch.tensor(0.4, dtype=torch.float64))
    now = attitude(torch.tensor(0.4, dtype=torch.float64))
    torch.testing.assert_close(rotations.quaternion_derivative(now, rate), expected)


def test_angle_between_attitudes():
    start = some_rotations(20)
    turn = torch.linspace(0.0, torch.pi, 20, dtype=torch.float64)
    axis = torch.tensor([0.0, 0.6, 0.8], dtype=torch.float64)
    end = rotations.multiply(start, rotations.from_rotation_vector(turn[:, None] * axis))
    torch.testing.assert_close(rotations.rotation_angle(start, end), turn)
    torch.testing.assert_close(rotations.rotation_angle(start, -end), turn)


@pytest.mark.parametrize(
    "function",
    [rotations.to_matrix, rotations.to_rotation_vector, rotations.normalize, rotations.conjugate],
)
def test_gradients_of_maps_of_a_rotation(function):
    assert torch.autograd.gradcheck(function, some_rotations(5).requires_grad_())


def test_gradients_of_rotating_and_of_conversions():
    quaternion = some_rotations(5).requires_grad_()
    vector = torch.randn(5, 3, dtype=torch.float64, generator=torch.Generator().manual_seed(1))
    vector.requires_grad_()
    for function in (rotations.rotate, rotations.rotate_inverse, rotations.quaternion_derivative):
        assert torch.autograd.gradcheck(function, (quaternion, vector))
    assert torch.autograd.gradcheck(rotations.from_rotation_vector, vector)
    matrix = rotations.to_matrix(quaternion).detach().requires_grad_()
    assert torch.autograd.gradcheck(rotations.from_matrix, matrix)


def test_gradients_exist_at_no_rotation():
    vector = torch.zeros(3, dtype=torch.float64, requires_grad=True)
    jacobian = torch.autograd.functional.jacobian(
        lambda v: rotations.to_rotation_vector(rotations.from_rotation_vector(v)), vector
    )
    torch.testing.assert_close(jacobian, torch.eye(3, dtype=torch.float64))


def test_one_alone_equals_one_of_many():
    quaternions = some_rotations(7)
    vector = torch.tensor([0.1, -0.7, 2.0], dtype=torch.float64)
    together = rotations.rotate(quaternions, vector)
    alone = torch.stack([rotations.rotate(quaternion, vector) for quaternion in quaternions])
    assert torch.equal(together, alone)


@pytest.mark.parametrize("shape", [(), (4,), (2500, 1)])
def test_a_compiled_loop_turns_many_as_tensors_turn_each(shape):
    """Whatever asks for gradients is left to tensors."""
    quaternion, vector = some_rotations(2500, 4), some_rotations(*shape, seed=1)[..., 1:]
    for turn in (rotations.rotate, rotations.rotate_inverse):
        by_tensors = turn(quaternion.clone().requires_grad_(), vector)
        assert by_tensors.requires_grad
        torch.testing.assert_close(turn(quaternion, vector), by_tensors.detach(), rtol=0.0, atol=1e-14)
    axis = quaternion[..., 1:]
    by_tensors = rotations.cross(axis.clone().requires_grad_(), vector).detach()
    torch.testing.assert_close(rotations.cross(axis, vector), by_tensors, rtol=0.0, atol=1e-14)
