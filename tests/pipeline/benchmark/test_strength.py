"""How strong a concealed effect is made."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from simgap.benchmark.strength import BOUNDS, MOST, is_settled, settle_strength


@given(st.floats(0.0, 6), st.floats(1.0, 4.0))
def test_a_faint_effect_is_near_the_noise_wherever_the_usual_one_shows(size, power):
    strength, energy = settle_strength(lambda s: 10.0**size * s**power, "faint")
    assert is_settled(energy, "faint")
    assert energy == 10.0**size * strength**power


@given(st.floats(-6, 6), st.floats(1.0, 4.0), st.sampled_from(["clear", "faint"]))
def test_no_effect_is_stronger_than_on_any_machine(size, power, wanted):
    strength, _ = settle_strength(lambda s: 10.0**size * s**power, wanted)
    assert strength <= MOST


def test_a_threshold_is_found_between_what_shows_nothing_and_too_much():
    _, energy = settle_strength(lambda s: 1e4 * max(s - 0.5, 0.0) ** 2, "faint")
    assert is_settled(energy, "faint")


def test_what_is_clear_at_its_usual_strength_keeps_it():
    assert settle_strength(lambda s: 400.0 * s * s, "clear") == (1.0, 400.0)


def test_what_is_not_becomes_as_clear_as_a_machine_allows():
    strength, energy = settle_strength(lambda s: 2.0 * s * s, "clear")
    assert 1.0 < strength < MOST
    assert energy >= BOUNDS["clear"][0]
    assert settle_strength(lambda s: 0.1 * s * s, "clear") == (MOST, pytest.approx(0.1 * MOST**2))


def test_what_never_shows_is_not_settled():
    _, energy = settle_strength(lambda s: -1e-3, "faint")
    assert not is_settled(energy, "faint")
    assert math.isfinite(energy)
