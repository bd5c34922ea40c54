import torch

from simgap.physics import rigid_body, rotations
from simgap.physics.integrators import rk4

INERTIA = torch.tensor([2.0e-3, 3.1e-3, 4.2e-3], dtype=torch.float64)


def random(*shape: int, seed: int = 0) -> torch.Tensor:
    return torch.randn(*shape, dtype=torch.float64, generator=torch.Generator().manual_seed(seed))


def tumble(state: torch.Tensor) -> torch.Tensor:
    attitude, body_rate = state[..., :4], state[..., 4:]
    spin_up = rigid_body.angular_acceleration(body_rate, torch.zeros_like(body_rate), INERTIA)
    return torch.cat((rotations.quaternion_derivative(attitude, body_rate), spin_up), dim=-1)


def test_torque_free_tumbling_keeps_angular_momentum_and_energy():
    attitude = rotations.normalize(random(6, 4))
    body_rate = 5.0 * random(6, 3, seed=1)
    state = torch.cat((attitude, body_rate), dim=-1)
    for _ in range(400):
        state = rk4(tumble, state, 1e-3)
    end_attitude, end_rate = state[..., :4], state[..., 4:]
    torch.testing.assert_close(
        rigid_body.angular_momentum(end_attitude, end_rate, INERTIA),
        rigid_body.angular_momentum(attitude, body_rate, INERTIA),
        rtol=1e-6,
        atol=1e-9,
    )
    torch.testing.assert_close(
        rigid_body.rotational_energy(end_rate, INERTIA),
        rigid_body.rotational_energy(body_rate, INERTIA),
        rtol=1e-8,
        atol=0,
    )
    assert (end_rate - body_rate).abs().max() > 0.1  # it did tumble


def test_gyroscopic_torque_does_no_work():
    body_rate, spin_momentum = random(100, 3), random(100, 3, seed=1)
    work = (body_rate * rigid_body.gyroscopic_torque(body_rate, spin_momentum)).sum(dim=-1)
    torch.testing.assert_close(work, torch.zeros(100, dtype=torch.float64), atol=1e-12, rtol=0)


def test_gyroscopic_torque_precesses_a_spinning_top_the_right_way():
    """Nose up (about −y), a spin about +z is carried towards −x: the body feels the opposite torque, +x."""
    torque = rigid_body.gyroscopic_torque(torch.tensor([0.0, -1.0, 0.0]), torch.tensor([0.0, 0.0, 2.0]))
    torch.testing.assert_close(torque, torch.tensor([2.0, 0.0, 0.0]))


def test_gyroscopic_torque_is_what_euler_has_for_a_carried_spin():
    """Total momentum Jω + h of a free body with constant h is kept in the world frame."""
    spin = torch.tensor([0.0, 0.0, 0.01], dtype=torch.float64)

    def derivative(state: torch.Tensor) -> torch.Tensor:
        attitude, body_rate = state[..., :4], state[..., 4:]
        torque = rigid_body.gyroscopic_torque(body_rate, spin)
        spin_up = rigid_body.angular_acceleration(body_rate, torque, INERTIA)
        return torch.cat((rotations.quaternion_derivative(attitude, body_rate), spin_up), dim=-1)

    state = torch.cat((rotations.normalize(random(4)), random(3, seed=2)))
    before = rotations.rotate(state[:4], INERTIA * state[4:] + spin)
    for _ in range(400):
        state = rk4(derivative, state, 1e-3)
    after = rotations.rotate(state[:4], INERTIA * state[4:] + spin)
    torch.testing.assert_close(after, before, rtol=1e-8, atol=1e-12)


def test_hover_and_free_fall():
    level = torch.tensor([1.0, 0.0, 0.0, 0.0])
    hover = rigid_body.linear_acceleration(level, torch.tensor([0.0, 0.0, 9.81]), 9.81)
    fall = rigid_body.linear_acceleration(level, torch.zeros(3), 9.81)
    torch.testing.assert_close(hover, torch.zeros(3))
    torch.testing.assert_close(fall, torch.tensor([0.0, 0.0, -9.81]))


def test_gradients():
    arguments = [random(3, 3, seed=seed).requires_grad_() for seed in (0, 1)]
    inertia = INERTIA.clone().requires_grad_()
    assert torch.autograd.gradcheck(rigid_body.angular_acceleration, (*arguments, inertia))
    attitude = rotations.normalize(random(3, 4)).requires_grad_()
    assert torch.autograd.gradcheck(
        lambda q, f: rigid_body.linear_acceleration(q, f, 9.81), (attitude, arguments[0])
    )
