import hypothesis.strategies as st
import pytest
import torch
from hypothesis import given

from simgap.physics import friction

LAWS = {
    "coulomb": lambda v: friction.coulomb(v, 0.3),
    "smooth coulomb": lambda v: friction.coulomb(v, 0.3, smoothing=0.01),
    "viscous": lambda v: friction.viscous(v, 0.2),
    "stribeck": lambda v: friction.stribeck(v, 0.3, 0.5, 0.05),
}


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS.keys())
@given(velocity=st.floats(-5, 5))
def test_friction_dissipates_and_is_odd(law, velocity):
    velocity = torch.tensor(velocity, dtype=torch.float64)
    assert float(law(velocity) * velocity) <= 0.0
    torch.testing.assert_close(law(-velocity), -law(velocity))


def test_smooth_sign_tends_to_the_exact_one():
    velocity = torch.tensor([-1.0, -0.1, 0.1, 1.0])
    torch.testing.assert_close(friction.coulomb(velocity, 2.0, 1e-3), friction.coulomb(velocity, 2.0))


def test_stribeck_level_falls_from_static_to_kinetic():
    velocity = torch.tensor([0.0, 0.01, 0.05, 10.0], dtype=torch.float64)
    level = friction.stribeck_level(velocity, 0.3, 0.5, 0.05)
    assert float(level[0]) == pytest.approx(0.5)
    assert float(level[-1]) == pytest.approx(0.3)
    assert (level.diff() < 0).all()


def test_lugre_slides_at_the_level_of_friction():
    velocity = torch.tensor([0.2, -0.7], dtype=torch.float64)
    deflection = torch.zeros(2, dtype=torch.float64)
    for _ in range(1000):
        deflection = friction.lugre_bristle_step(deflection, velocity, 0.4, 1e3, 1e-3)
    rate = friction.lugre_bristle_rate(deflection, velocity, 0.4, 1e3)
    force = friction.lugre(deflection, rate, 1e3, 1.0)
    torch.testing.assert_close(force, torch.tensor([-0.4, 0.4], dtype=torch.float64))


def test_lugre_step_solves_the_bristle_equation():
    velocity = torch.tensor([0.05], dtype=torch.float64)
    deflection = torch.tensor([1e-4], dtype=torch.float64)
    fine = deflection
    for _ in range(2_000):
        fine = fine + 5e-6 * friction.lugre_bristle_rate(fine, velocity, 0.4, 1e3)
    coarse = friction.lugre_bristle_step(deflection, velocity, 0.4, 1e3, 1e-2)
    torch.testing.assert_close(coarse, fine, rtol=1e-3, atol=0)


def test_lugre_holds_still_and_stores_no_more_than_it_is_given():
    """Over a back-and-forth motion from rest the work done against LuGre friction is never negative."""
    dt, stiffness, damping = 2e-4, 1e3, 2.0
    time = torch.arange(6_000, dtype=torch.float64) * dt
    velocity = 0.1 * torch.sin(7.0 * time) + 0.03 * torch.sin(31.0 * time)
    deflection, work = torch.zeros((), dtype=torch.float64), 0.0
    for v in velocity:
        rate = friction.lugre_bristle_rate(deflection, v, 0.4, stiffness)
        work -= float(friction.lugre(deflection, rate, stiffness, damping) * v) * dt
        assert work > -1e-9
        deflection = friction.lugre_bristle_step(deflection, v, 0.4, stiffness, dt)
    at_rest = friction.lugre_bristle_step(deflection, torch.zeros_like(deflection), 0.4, stiffness, 1.0)
    assert torch.equal(at_rest, deflection)


def test_gradients():
    velocity = torch.tensor([-0.3, 0.02, 0.4], dtype=torch.float64, requires_grad=True)
    assert torch.autograd.gradcheck(lambda v: friction.stribeck(v, 0.3, 0.5, 0.05, 0.01), velocity)
    deflection = torch.tensor([1e-4, 2e-4, -1e-4], dtype=torch.float64, requires_grad=True)
    assert torch.autograd.gradcheck(
        lambda z, v: friction.lugre_bristle_step(z, v, 0.4, 1e3, 1e-3), (deflection, velocity)
    )
