"""One case against its key: hand-made keys and diagnoses with known scores."""

import copy
import hashlib
import json

import pytest

from simgap.benchmark.score import effect_name, open_key, right_verdict, score_case
from simgap.errors import InputError


def effect(name, group=None, **values):
    parameters = {key: {"value": value, "unit": "1"} for key, value in values.items()}
    return {"name": name, "parameters": parameters} | ({"acts_on": group} if group else {})


def key(*effects, outside=()):
    return {
        "schema": "simgap.key/1",
        "effects": list(effects),
        "outside": [{"name": name} for name in outside],
    }


def diagnosis(*effects, verdict="missing_physics", ambiguous=(), unnamed=0, gap_closed=0.9):
    """Each effect is (name, probability, acts_on, values)."""
    return {
        "verdict": verdict,
        "effects": [
            {"name": name, "probability": p, "acts_on": group}
            | {"parameters": {k: {"value": v, "std": 0.1, "unit": "1"} for k, v in values.items()}}
            for name, p, group, values in effects
        ],
        "ambiguous": [{"names": list(names), "separate_by": ""} for names in ambiguous],
        "unnamed": [{"channel": "force_x"}] * unnamed,
        "fit": {"gap_closed": gap_closed},
    }


DRAG = effect("rotor_drag", coefficient=0.4)


def test_the_right_name_first_is_right_and_its_value_is_compared():
    found = diagnosis(("rotor_drag", 0.9, "force", {"coefficient": 0.38}))
    score = score_case(key(DRAG), found)
    assert (score["outcome"], score["found"], score["verdict_right"]) == ("right", 1.0, True)
    assert score["errors"]["rotor_drag"]["coefficient"] == pytest.approx(0.05)
    assert score["stated"] == [[0.9, True]]


def test_the_runs_of_an_effect_are_right_where_they_are_listed():
    late = key(DRAG) | {"acts_in_runs": ["b", "c"]}
    found = diagnosis(("rotor_drag", 0.9, "force", {"coefficient": 0.4}), ("body_drag", 0.6, "force", {}))
    assert score_case(late, found)["runs_right"] == [False]
    found["effects"][0]["runs"] = ["b", "c"]
    assert score_case(late, found)["runs_right"] == [True]
    assert score_case(key(DRAG), found)["runs_right"] == []


def test_what_comes_with_it_may_be_named_and_need_not_be():
    slip, creep = (effect(name, "drive", value=0.2) for name in ("wheel_slip", "tyre_creep"))
    case = key(slip) | {"beside": [creep]}
    both = score_case(
        case, diagnosis(("tyre_creep", 0.9, "drive", {}), ("wheel_slip", 0.8, "drive", {"value": 0.2}))
    )
    assert (both["outcome"], both["found"]) == ("right", 1.0)
    assert both["stated"] == [[0.9, True], [0.8, True]]
    alone = score_case(case, diagnosis(("wheel_slip", 0.9, "drive", {"value": 0.2})))
    assert (alone["outcome"], alone["found"]) == ("right", 1.0)
    without = score_case(case, diagnosis(("tyre_creep", 0.9, "drive", {})), wanted=("wheel_slip@drive",))
    assert (without["outcome"], without["found"]) == ("wrong", 0.0)


def test_a_wrong_name_before_the_right_one_is_wrong():
    found = diagnosis(("body_drag", 0.95, "force", {}), ("rotor_drag", 0.9, "force", {"coefficient": 0.4}))
    score = score_case(key(DRAG), found)
    assert (score["outcome"], score["found"]) == ("wrong", 1.0)
    assert score["stated"] == [[0.95, False], [0.9, True]]


def test_a_tie_that_is_said_is_ambiguous_only_with_the_name_that_was_given():
    names = ("body_drag", "rotor_drag")
    first = ("body_drag", 0.5, "force", {})
    assert score_case(key(DRAG), diagnosis(first, ambiguous=[names]))["outcome"] == "ambiguous"
    assert (
        score_case(key(DRAG), diagnosis(first, ambiguous=[("body_drag", "steady_wind")]))["outcome"]
        == "wrong"
    )
    assert (
        score_case(key(DRAG), diagnosis(first, ambiguous=[("mass_error", "rotor_drag")]))["outcome"]
        == "wrong"
    )


@pytest.mark.parametrize(
    ("verdict", "outcome"), [("unexplained", "unnamed"), ("none", "missed"), ("parameter_mismatch", "missed")]
)
def test_without_any_name_the_verdict_tells_whether_something_was_seen(verdict, outcome):
    score = score_case(key(DRAG), diagnosis(verdict=verdict))
    assert (score["outcome"], score["found"]) == (outcome, 0.0)


def test_what_is_named_without_belief_is_not_found():
    score = score_case(key(DRAG), diagnosis(("rotor_drag", 0.4, "force", {"coefficient": 0.4})))
    assert (score["outcome"], score["found"]) == ("right", 0.0)


def test_a_null_is_right_only_where_nothing_is_named():
    assert score_case(key(), diagnosis(verdict="none"))["outcome"] == "right"
    alarm = score_case(key(), diagnosis(("rotor_drag", 0.2, "force", {})))
    assert (alarm["outcome"], alarm["found"], alarm["stated"]) == ("wrong", None, [[0.2, False]])


def test_a_failed_diagnosis_counts_as_wrong():
    score = score_case(key(DRAG), None)
    assert (score["outcome"], score["found"], score["verdict_right"]) == ("failed", 0.0, False)


def test_half_of_a_pair_is_half_found():
    pair = key(DRAG, effect("mass_error", ratio=1.2))
    score = score_case(pair, diagnosis(("mass_error", 0.9, "force", {"ratio": 1.1})))
    assert (score["outcome"], score["found"]) == ("right", 0.5)
    assert score["errors"] == {"mass_error": {"ratio": pytest.approx(0.5)}}


def test_what_a_case_is_about_has_to_be_named_beside_what_makes_it_show():
    windy = key(effect("steady_wind", wind_x=3.0), DRAG)
    half = diagnosis(("rotor_drag", 0.9, "force", {"coefficient": 0.4}))
    whole = diagnosis(("rotor_drag", 0.9, "force", {}), ("steady_wind", 0.8, "force", {"wind_x": 3.0}))
    assert score_case(windy, half, ["steady_wind"])["outcome"] == "wrong"
    assert score_case(windy, whole, ["steady_wind"])["outcome"] == "right"


def test_a_swerve_drives_effect_is_right_only_in_its_group():
    slip = key(effect("coulomb_friction", "steer", level=1.0))
    assert (
        score_case(slip, diagnosis(("coulomb_friction", 0.9, "steer", {"level": 1.0})))["outcome"] == "right"
    )
    assert (
        score_case(slip, diagnosis(("coulomb_friction", 0.9, "drive", {"level": 1.0})))["outcome"] == "wrong"
    )


def test_acts_on_is_ignored_where_the_key_has_no_groups():
    assert effect_name({"name": "rotor_drag", "acts_on": "force"}, grouped=False) == "rotor_drag"
    assert score_case(key(DRAG), diagnosis(("rotor_drag", 0.9, "torque", {})))["outcome"] == "right"


def test_components_of_one_thing_are_compared_together_and_the_strength_comes_first():
    true = key(effect("steady_wind", wind_y=4.0, wind_x=3.0, shear=1.0))
    found = diagnosis(("steady_wind", 0.9, "force", {"wind_x": 3.0, "wind_y": 3.0, "shear": 1.5}))
    errors = score_case(true, found)["errors"]["steady_wind"]
    assert list(errors) == ["wind", "shear"]
    assert errors == {"wind": pytest.approx(0.2), "shear": pytest.approx(0.5)}


def test_an_error_of_a_ratio_is_relative_to_its_distance_from_one():
    found = diagnosis(("mass_error", 0.9, "force", {"ratio": 1.08}), verdict="parameter_mismatch")
    assert score_case(key(effect("mass_error", ratio=1.1)), found)["errors"]["mass_error"][
        "ratio"
    ] == pytest.approx(0.2)


def test_parameters_under_other_names_are_not_compared():
    found = diagnosis(("rotor_drag", 0.9, "force", {"factor": 0.4}))
    assert score_case(key(DRAG), found)["errors"] == {"rotor_drag": {}}


@pytest.mark.parametrize(
    ("answer", "verdict"),
    [
        (key(DRAG), "missing_physics"),
        (key(DRAG, effect("mass_error", ratio=1.1)), "missing_physics"),
        (key(effect("mass_error", ratio=1.1)), "parameter_mismatch"),
        (key(effect("mass_error", ratio=1.1), outside=["gusts"]), "unexplained"),
        (key(outside=["gusts"]), "unexplained"),
        (key(), "none"),
    ],
)
def test_every_key_deserves_one_verdict(answer, verdict):
    assert right_verdict(answer) == verdict


def test_scoring_leaves_key_and_diagnosis_as_they_are():
    answer, found = key(DRAG), diagnosis(("rotor_drag", 0.9, "force", {"coefficient": 0.4}))
    before = copy.deepcopy((answer, found))
    score_case(answer, found)
    assert (answer, found) == before


def test_a_key_that_was_changed_after_it_was_sealed_is_refused(tmp_path):
    path = tmp_path / "key.json"
    path.write_text(json.dumps(key(DRAG)), encoding="utf-8")
    source = f"a plant, answer key sha256:{hashlib.sha256(path.read_bytes()).hexdigest()}"
    assert open_key(path, source) == key(DRAG)
    path.write_text(json.dumps(key(effect("rotor_drag", coefficient=0.5))), encoding="utf-8")
    with pytest.raises(InputError, match="not the key that the recording was sealed with"):
        open_key(path, source)
