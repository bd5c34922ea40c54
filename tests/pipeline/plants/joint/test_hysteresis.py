import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simgap.plants.joint.hysteresis import bouc_wen, nearest_law

strains = st.floats(-0.99, 0.99)
travels = st.floats(-1.0, 1.0)


def one(value):
    return np.array([value])


@given(strains, travels, st.floats(0.0, 1.0))
def test_a_travel_may_be_cut_in_two(strain, travel, share):
    whole = bouc_wen(one(strain), one(travel), 0.1)
    half = bouc_wen(one(strain), one(share * travel), 0.1)
    cut = bouc_wen(half, one((1 - share) * travel), 0.1)
    np.testing.assert_allclose(cut, whole, atol=1e-12)


@given(strains, travels)
def test_it_keeps_its_differential_equation(strain, travel):
    small = 1e-7 * np.sign(travel)
    after = bouc_wen(one(strain), one(small), 0.1)[0]
    slope = (1.0 - strain**2 * (1.0 + np.sign(strain * small)) / 2.0) / 0.1
    assert after - strain == pytest.approx(slope * small, rel=1e-4, abs=1e-14)


def test_a_loop_takes_energy_and_the_part_yields_at_its_level():
    position = np.sin(np.linspace(0.0, 4.0 * np.pi, 4001))
    strain, work = one(0.0), 0.0
    for travel in np.diff(position):
        strain = bouc_wen(strain, one(travel), 0.1)
        work += strain[0] * travel
    assert work > 0
    assert 0.99 < abs(strain[0]) <= 1.0


def strains_along(position, displacement):
    strain, strains = one(0.0), []
    for travel in np.diff(position):
        strain = bouc_wen(strain, one(travel), displacement)
        strains.append(strain[0])
    return np.array(strains)


def deflections_along(position, displacement, asymmetry):
    """Return what a diagnosis says, by many small steps of its differential equation."""
    deflection, deflections = 0.0, []
    for travel in np.diff(position):
        for _ in range(5):
            bent = deflection * np.sign(travel) + asymmetry * abs(deflection)
            slope = 1.0 - bent / np.hypot(1.0 + asymmetry, asymmetry)
            deflection += slope * travel / 5 / displacement
        deflections.append(deflection)
    return np.array(deflections)


@pytest.mark.parametrize("amplitude", [0.1, 0.8])
def test_the_nearest_law_comes_near_and_is_not_the_plant(amplitude):
    angle = np.linspace(0.0, 6.0 * np.pi, 3001)
    position = amplitude * (0.7 * np.sin(angle) + 0.3 * np.sin(2.7 * angle))
    level, displacement, asymmetry = nearest_law(position[:, None], 0.2, 0.05)
    true = 0.2 * strains_along(position, 0.05)
    missed = np.square(true - level * deflections_along(position, displacement, asymmetry)).sum()
    assert 1e-4 < missed / np.square(true).sum() < 0.01
    dahl = deflections_along(position, displacement, 0.0)
    assert missed < 0.5 * np.square(true - (true @ dahl) / (dahl @ dahl) * dahl).sum()
    settled = level * np.hypot(1.0 + asymmetry, asymmetry) / (1.0 + asymmetry)
    assert settled == pytest.approx(0.2, rel=0.1 if amplitude > 0.5 else 0.3)


def test_no_law_beside_the_nearest_comes_nearer():
    position = 0.4 * np.sin(np.linspace(0.0, 15.0, 2001)) * np.linspace(0.2, 1.0, 2001)
    level, displacement, asymmetry = nearest_law(position[:, None], 1.0, 0.05)
    true = strains_along(position, 0.05)

    def missed(size, shape):
        return np.square(true - level * size * deflections_along(position, *shape)).sum()

    least = missed(1.0, (displacement, asymmetry))
    for size, shape in (
        (1.05, (displacement, asymmetry)),
        (0.95, (displacement, asymmetry)),
        (1.0, (1.05 * displacement, asymmetry)),
        (1.0, (0.95 * displacement, asymmetry)),
        (1.0, (displacement, asymmetry + 0.1)),
        (1.0, (displacement, asymmetry - 0.1)),
    ):
        assert missed(size, shape) > least
