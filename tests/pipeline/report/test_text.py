import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from simgap.report import text


@pytest.mark.parametrize(
    ("value", "std", "unit", "written"),
    [
        (0.4512, 0.0083, "1/s", "0.4512 ± 0.0083 s⁻¹"),
        (-0.08, 0.02, "m/s^2", "−0.080 ± 0.020 m/s²"),
        (3.7178e-8, 2.4e-11, "N/(rad/s)^2", "(3.7178 ± 0.0024)×10⁻⁸ N/(rad/s)²"),
        (1.123, 0.004, "1", "1.1230 ± 0.0040"),
        (0.0, 0.5, "m", "0.00 ± 0.50 m"),
        (2.0, None, "V", "2.000 V"),
        (None, None, "V", "unknown V"),
        (12345.6, 230.0, "rad/s", "12346 ± 230 rad/s"),
    ],
)
def test_an_estimate_is_rounded_by_its_standard_error(value, std, unit, written):
    assert text.estimate(value, std, unit).replace(text.NO_BREAK, " ") == written


@given(st.floats(-1e12, 1e12).filter(lambda x: x == 0 or abs(x) > 1e-12), st.integers(2, 6))
def test_a_number_is_written_to_its_digits(value, digits):
    superscripts = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹−", "-0123456789-")
    written = text.number(value, digits).translate(superscripts).replace("×10", "e")
    assert math.isclose(float(written), value, rel_tol=0.51 * 10.0 ** (1 - digits) * 10, abs_tol=0)


@pytest.mark.parametrize(
    ("value", "written"), [(1.2, "1.2"), (2.0, "2"), (0.4, "0.4"), (120.0, "120"), (0, "0"), (5e-7, "5×10⁻⁷")]
)
def test_a_short_number_has_no_trailing_zeros(value, written):
    assert text.short(value) == written


def test_no_probability_is_certain():
    assert text.probability(1.0).startswith(">")
    assert text.probability(0.0).startswith("<")
    assert "98" in text.probability(0.98)


@pytest.mark.parametrize("nothing", [None, float("nan"), float("inf")])
def test_what_is_not_known_is_said(nothing):
    for write in (text.number, text.percent, text.probability, text.p_value):
        assert write(nothing) == text.UNKNOWN
    assert text.interval([0.1, nothing]) == ""


def test_a_p_value_below_the_resolution_is_a_bound():
    assert text.p_value(0.0) == text.p_value(1e-40) != text.UNKNOWN
    assert text.p_value(3e-7) == "3×10⁻⁷"
    assert text.p_value(0.041) == "0.041"


@pytest.mark.parametrize(
    ("unit", "written"),
    [
        ("1", ""),
        (None, ""),
        ("1/s", "s⁻¹"),
        ("1/s^2", "s⁻²"),
        ("kg*m^2", "kg·m²"),
        ("m/s**2", "m/s²"),
        ("m/s²", "m/s²"),
    ],
)
def test_units_are_set_as_in_print(unit, written):
    assert text.pretty_unit(unit) == written


@pytest.mark.parametrize(
    ("words", "written"),
    [
        ("(correlation -0.99)", "(correlation −0.99)"),
        ("-0.941·voltage -0.0605·velocity", "−0.941·voltage −0.0605·velocity"),
        ("+3·x -.5", "+3·x −.5"),
        ("run-1 of 2026-11-25, one-step", "run-1 of 2026-11-25, one-step"),
        ("chance 2e-05 of 1.5e-12", "chance 2×10⁻⁵ of 1.5×10⁻¹²"),
    ],
)
def test_a_minus_is_one_sign_and_a_hyphen_stays(words, written):
    assert text.minus(words) == written


@given(st.text())
def test_a_minus_once_written_stays(words):
    assert text.minus(text.minus(words)) == text.minus(words)


def test_a_name_breaks_after_its_underscores_and_is_escaped():
    assert text.breakable("motor_speed_1") == "motor_<wbr>speed_<wbr>1"
    assert text.breakable("<b>_") == "&lt;b&gt;_<wbr>"


def test_lists_read_as_sentences():
    assert text.listed(["a"]) == "a"
    assert text.listed(["a", "b", "c"]) == "a, b and c"
    assert text.listed(["a", "b"], "or") == "a or b"
    assert text.listed([]) == ""


def test_a_sentence_of_the_diagnosis_is_written_as_print():
    said = "beside coulomb friction: explains 4% in run_4, equals rotor_drag at -3"
    assert (
        text.sentence(said)
        == f"beside Coulomb friction: explains 4{text.NARROW_SPACE}% in run_4, equals rotor drag at −3"
    )
