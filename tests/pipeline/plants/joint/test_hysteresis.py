import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simgap.plants.joint.hysteresis import bouc_wen, dahl, nearest_dahl

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
    slope = (1.0 - abs(strain) * (1.0 + np.sign(strain * small)) / 2.0) / 0.1
    assert after - strain == pytest.approx(slope * small, rel=1e-4, abs=1e-14)


def test_a_loop_takes_energy_and_both_laws_yield_at_their_level():
    position = np.sin(np.linspace(0.0, 4.0 * np.pi, 4001))
    for law in (bouc_wen, dahl):
        strain, work = one(0.0), 0.0
        for travel in np.diff(position):
            strain = law(strain, one(travel), 0.1)
            work += strain[0] * travel
        assert work > 0
        assert abs(strain[0]) <= 1.0


def test_the_nearest_law_of_dahl_comes_near():
    position = 0.8 * np.sin(np.linspace(0.0, 6.0 * np.pi, 3001))[:, None]
    level, displacement = nearest_dahl(position, 0.2, 0.05)
    true, law = one(0.0), one(0.0)
    errors, sizes = 0.0, 0.0
    for travel in np.diff(position[:, 0]):
        true, law = bouc_wen(true, one(travel), 0.05), dahl(law, one(travel), displacement)
        errors += (0.2 * true[0] - level * law[0]) ** 2
        sizes += (0.2 * true[0]) ** 2
    assert errors < 0.01 * sizes
    assert level == pytest.approx(0.2, rel=0.05)
