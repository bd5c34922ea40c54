import pytest

from simgap.report.verdict import sentence
from tests.pipeline.report.diagnoses import VERDICTS, diagnosis


def test_missing_physics_is_named_with_value_probability_and_gap_closed():
    said = sentence(diagnosis("missing_physics")).replace("\u202f", "").replace("\u00a0", " ")
    assert said.startswith(
        "The simulator leaves out rotor drag (coefficient 0.4512 ± 0.0083 s⁻¹, probability >99%)"
    )
    assert "97% of the gap closes" in said
    assert "95% interval 95% to 98%" in said


def test_a_parameter_mismatch_is_not_called_missing_physics():
    said = sentence(diagnosis("parameter_mismatch"))
    assert said.startswith("No physics is missing")
    assert "true over nominal" in said


def test_corrections_beside_missing_physics_are_told_apart():
    found = diagnosis("missing_physics")
    found["effects"] += diagnosis("parameter_mismatch")["effects"]
    said = sentence(found)
    assert said.index("rotor drag") < said.index("nominal parameters need correcting: mass error")


def test_a_long_list_of_effects_stays_a_sentence():
    found = diagnosis("missing_physics")
    found["effects"] = [found["effects"][0] | {"name": f"effect_{number}"} for number in range(8)]
    assert " and 5 more; with that" in sentence(found)


def test_an_unexplained_gap_names_its_variables():
    assert "torque y follows velocity x and motor speed" in sentence(diagnosis("unexplained"))


def test_an_effect_in_two_groups_is_told_apart_by_its_group():
    found = diagnosis("missing_physics")
    found["effects"] = [
        found["effects"][0] | {"name": "viscous_friction", "acts_on": group} for group in ("drive", "steer")
    ]
    said = sentence(found)
    assert "viscous friction (drive)" in said
    assert "viscous friction (steer)" in said


def test_an_unknown_share_says_why():
    found = diagnosis("missing_physics")
    found["fit"]["gap_closed"] = None
    assert "too close to its floor" in sentence(found)
    found["fit"]["held_out_runs"] = []
    assert "no run could be held out" in sentence(found)


@pytest.mark.parametrize("bare", [False, True])
@pytest.mark.parametrize("verdict", [*VERDICTS, "something_new"])
def test_every_verdict_is_one_sentence(verdict, bare):
    found = diagnosis(verdict if verdict in VERDICTS else "none", bare=bare) | {"verdict": verdict}
    said = sentence(found)
    assert said.endswith(".")
    assert ". " not in said
