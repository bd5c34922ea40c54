import pytest
import torch

from simgap.physics.integrators import euler, rk4, semi_implicit


def oscillator(state: torch.Tensor) -> torch.Tensor:
    return torch.stack((state[..., 1], -state[..., 0]), dim=-1)


def semi_implicit_oscillator(_derivative, state: torch.Tensor, dt: float) -> torch.Tensor:
    pair = semi_implicit(lambda position, _velocity: -position, state[..., :1], state[..., 1:], dt)
    return torch.cat(pair, dim=-1)


def error_after_one_second(step, steps: int) -> float:
    state = torch.tensor([1.0, 0.0], dtype=torch.float64)
    for _ in range(steps):
        state = step(oscillator, state, 1.0 / steps)
    one = torch.tensor(1.0, dtype=torch.float64)
    return float(torch.linalg.vector_norm(state - torch.stack((torch.cos(one), -torch.sin(one)))))


@pytest.mark.parametrize(("step", "order"), [(euler, 1), (semi_implicit_oscillator, 1), (rk4, 4)])
def test_error_falls_with_the_order_of_the_integrator(step, order):
    ratio = error_after_one_second(step, 40) / error_after_one_second(step, 80)
    assert ratio == pytest.approx(2.0**order, rel=0.08)


def test_rk4_is_exact_for_cubic_motion():
    def derivative(state: torch.Tensor) -> torch.Tensor:  # (t, x) with dx/dt = 3 t²
        return torch.stack((torch.ones_like(state[..., 0]), 3.0 * state[..., 0] ** 2), dim=-1)

    end = rk4(derivative, torch.zeros(2, dtype=torch.float64), 2.0)
    torch.testing.assert_close(end, torch.tensor([2.0, 8.0], dtype=torch.float64))


def test_semi_implicit_keeps_the_energy_of_an_oscillator_bounded():
    position, velocity = torch.ones(1, dtype=torch.float64), torch.zeros(1, dtype=torch.float64)
    energies = []
    for _ in range(2000):
        position, velocity = semi_implicit(lambda x, _: -x, position, velocity, 0.1)
        energies.append(float(position**2 + velocity**2))
    assert max(energies) < 1.11
    assert min(energies) > 0.9


@pytest.mark.parametrize("step", [euler, semi_implicit_oscillator, rk4])
def test_one_alone_equals_one_of_many(step):
    states = torch.randn(9, 2, dtype=torch.float64, generator=torch.Generator().manual_seed(0))
    together = step(oscillator, states, 0.1)
    assert torch.equal(together, torch.stack([step(oscillator, state, 0.1) for state in states]))


def test_gradient_passes_through_a_rollout():
    def rollout(state: torch.Tensor) -> torch.Tensor:
        for _ in range(5):
            state = rk4(oscillator, state, 0.1)
        return state

    assert torch.autograd.gradcheck(rollout, torch.ones(2, dtype=torch.float64, requires_grad=True))
