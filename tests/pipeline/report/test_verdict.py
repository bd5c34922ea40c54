import pytest

from simgap.consistency.checked import Checked
from simgap.effects.told import UNTOLD
from simgap.recordings.contradiction import Contradiction
from simgap.report.doubts import doubts_of
from simgap.report.terminal import terminal_lines
from simgap.report.use import next_recordings
from simgap.report.verdict import headline, summary
from tests.pipeline.report.diagnoses import DOUBTED, UNFINISHED, VERDICTS, diagnosis


def plain(text: str) -> str:
    return text.replace("\u202f", "").replace("\u00a0", " ")


def test_the_headline_names_what_is_believed_and_nothing_else():
    found = diagnosis("missing_physics")
    found["effects"].append(DOUBTED)
    said = summary(found)
    assert said.headline == "The simulator leaves out rotor drag and axial inflow."
    assert [effect.name for effect in said.believed] == ["rotor_drag", "axial_inflow"]
    assert [effect.name for effect in said.perhaps] == ["blade_flapping_moment"]
    assert plain(said.believed[0].facts) == "coefficient 0.4512 ± 0.0083 s⁻¹, probability >99%"


@pytest.mark.parametrize(("probability", "believed"), [(0.5, True), (0.499, False), (None, False)])
def test_one_half_is_believed_and_less_is_not(probability, believed):
    found = diagnosis("missing_physics")
    found["effects"] = [DOUBTED | {"probability": probability}]
    assert ("blade flapping" in headline(found)) == believed
    assert len(summary(found).perhaps) == (not believed)


def test_where_nothing_is_believed_no_name_is_stated():
    found = diagnosis("missing_physics")
    found["effects"] = [DOUBTED]
    assert headline(found).endswith("no single cause is likelier than not.")


def test_a_wrong_number_is_said_also_where_no_missing_physics_is_believed():
    found = diagnosis("missing_physics")
    found["effects"] = [DOUBTED, DOUBTED | {"name": "input_scale_error", "probability": 0.9}]
    assert headline(found) == (
        "The platform file is wrong about input scale. "
        "Beside that, physics is missing from the simulator, but no single cause is likelier than not."
    )


def test_how_much_of_the_gap_closes_is_said_with_what_is_left():
    found = diagnosis("missing_physics")
    assert "closes 97% of the gap" in plain(summary(found).closed)
    assert "95% interval 95% to 98%" in plain(summary(found).closed)
    assert "What is left" not in summary(found).closed
    found["fit"]["after"] = 3 * found["fit"]["noise_floor"]
    assert summary(found).closed.endswith("What is left is 3 times the noise.")


def test_one_run_that_was_held_out_gives_no_interval_and_says_so():
    found = diagnosis("missing_physics")
    found["fit"] |= {"held_out_runs": ["melon_run1"], "gap_closed_interval": None}
    assert "closes 97% of the gap on runs never used for fitting (one run: no interval)." in plain(
        summary(found).closed
    )
    assert any("(one run: no interval)" in line for line in terminal_lines(found))


@pytest.mark.parametrize(
    ("closed", "after", "said"),
    [
        (0.55, 0.5, ("closes 55% of", "What is left is 5 times the noise.")),
        (0.9996, 0.1, ("closes 99.9% of", "")),
        (1.0, 0.09, ("closes 100% of", "")),
        (0.9987, 0.3, ("closes 99.8% of", "What is left is 3 times the noise.")),
    ],
)
def test_what_is_left_is_never_rounded_away(closed, after, said):
    found = diagnosis("missing_physics")
    found["fit"] |= {"gap_closed": closed, "after": after, "noise_floor": 0.1}
    written = plain(summary(found).closed)
    assert said[0] in written
    assert written.endswith(said[1] or "(95% interval 95% to 98%).")


def test_a_parameter_mismatch_is_not_called_missing_physics():
    assert headline(diagnosis("parameter_mismatch")) == (
        "No physics is missing. The platform file is wrong about mass."
    )


def test_corrections_beside_missing_physics_are_told_apart():
    found = diagnosis("missing_physics")
    found["effects"] += diagnosis("parameter_mismatch")["effects"]
    assert headline(found) == (
        "The simulator leaves out rotor drag and axial inflow, and the platform file is wrong about mass."
    )


def test_an_effect_in_two_groups_is_named_once_and_told_apart_below():
    found = diagnosis("missing_physics")
    found["effects"] = [
        found["effects"][0] | {"name": "viscous_friction", "acts_on": group} for group in ("drive", "steer")
    ]
    assert headline(found) == "The simulator leaves out viscous friction."
    assert [effect.words for effect in summary(found).believed] == [
        "viscous friction (drive)",
        "viscous friction (steer)",
    ]


def test_a_subject_is_said_wherever_the_name_is():
    found = diagnosis("missing_physics")
    entry = found["effects"][0]
    found["effects"] = [
        entry | {"name": "rotor_fault", "subject": "3"},
        entry | {"name": "rotor_fault", "subject": "4"},
        entry | {"name": "motor_constant_error", "subject": "drive"},
        entry | {"name": "rotor_drag", "subject": None},
    ]
    found["ambiguous"] = [
        {"names": ["backlash", "slope"], "subjects": ["steer", None], "separate_by": "Turn to and fro."}
    ]
    assert headline(found) == (
        "The simulator leaves out rotor fault (rotor 3 and rotor 4) and rotor drag, and the platform file is wrong "
        "about motor constant (drive)."
    )
    said = summary(found)
    assert [effect.words for effect in said.believed] == [
        "rotor fault (rotor 3)",
        "rotor fault (rotor 4)",
        "motor constant error (drive)",
        "rotor drag",
    ]
    assert said.ambiguous[0].startswith("backlash (steer) or slope: this recording cannot tell.")
    lines = terminal_lines(found)
    assert any(line.startswith("  rotor_fault (rotor 3): ") for line in lines)
    assert any(line.startswith("  rotor_drag: ") for line in lines)


def test_what_has_no_name_is_said_with_its_size_and_the_noise():
    (rest,) = summary(diagnosis("unexplained")).unnamed
    assert rest == "torque y: 0.21 N·m, 4.2 times the noise; it follows velocity x and motor speed"


@pytest.mark.parametrize(("noise", "mentioned"), [(0.1, True), (0.105, False), (0.3, False)])
def test_what_is_within_twice_the_noise_is_not_mentioned(noise, mentioned):
    found = diagnosis("unexplained")
    found["unnamed"][0]["size"]["noise"] = noise
    assert bool(summary(found).unnamed) == mentioned
    assert any("torque y" in line for line in terminal_lines(found)) == mentioned


def test_a_contradiction_is_the_headline_with_column_cause_and_remedy():
    found = diagnosis("contradiction")
    found["unnamed"] = diagnosis("unexplained")["unnamed"]
    said = summary(found)
    assert "voltage (another sign or frame)" in said.headline
    assert said.contradictions == [
        "torque: the machine moves against what is commanded (correlation -0.99). "
        "Compare the sign of 'voltage' with the platform file."
    ]
    assert said.unnamed == []
    assert said.closed == ""


def test_an_unknown_share_says_why():
    found = diagnosis("missing_physics")
    found["fit"]["gap_closed"] = None
    assert "too close to its floor" in summary(found).closed
    found["fit"]["held_out_runs"] = []
    assert "no run could be held out" in summary(found).closed


@pytest.mark.parametrize("bare", [False, True])
@pytest.mark.parametrize("verdict", [*VERDICTS, "something_new"])
def test_every_verdict_has_short_sentences_in_page_and_terminal(verdict, bare):
    found = diagnosis(verdict if verdict in VERDICTS else "none", bare=bare) | {"verdict": verdict}
    said = headline(found)
    assert said.endswith(".")
    assert all(len(sentence.split()) <= 20 for sentence in said.split(". "))
    assert terminal_lines(found)[:2] == [f"verdict: {verdict}", said]


def test_the_terminal_puts_doubts_below_what_is_believed_and_has_one_minus_sign():
    found = diagnosis("missing_physics")
    found["effects"].append(DOUBTED)
    lines = terminal_lines(found)
    assert lines.index("perhaps:") > lines.index(
        "  rotor_drag: coefficient 0.4512 ± 0.0083 s⁻¹, probability > 99%"
    )
    assert "  blade_flapping_moment: coefficient −0.0123 ± 0.0040 N·m/(m/s), probability 31%" in lines
    assert not any("\u202f" in line or "\u00a0" in line or " -0" in line for line in lines)


def test_a_search_that_was_ended_is_said_below_the_headline_and_not_twice():
    found = diagnosis("missing_physics")
    assert summary(found).unfinished == ""
    doubts = doubts_of(found)
    found["warnings"].append(UNFINISHED)
    said = "The search was ended before it was complete; this is the best answer so far (gap.budget=120 s)."
    assert summary(found).unfinished == said
    assert terminal_lines(found)[1:3] == [summary(found).headline, said]
    assert doubts_of(found) == doubts


def test_a_column_that_is_perhaps_another_one_stands_in_the_headline():
    suspected = Contradiction("position", "rotations", "'voltage' against the motion", "Convert it.")
    (warning,) = Checked((), suspected, 0.74).warnings
    found = diagnosis("unexplained")
    found["warnings"].insert(0, warning)
    assert headline(found).endswith(f" A{warning[1:]}")
    assert "74%" in warning
    assert warning not in doubts_of(found)


def test_held_out_runs_that_refute_the_answer_stand_in_the_headline():
    found = diagnosis("missing_physics")
    before, doubts = summary(found).headline, doubts_of(found)
    found["warnings"].insert(0, "held-out runs refute the named effects: do not rely on them")
    assert summary(found).headline == f"{before} Held-out runs refute the named effects: do not rely on them."
    assert doubts_of(found) == doubts


def test_no_number_is_given_of_a_size_that_is_not_told():
    found = diagnosis("missing_physics")
    unsure = {"value": 21.0, "std": 110.0, "unit": "N*m"}
    found["effects"] = [
        {"name": "dead_zone", "probability": 0.9, "parameters": {"width": unsure}, "statement": UNTOLD}
    ]
    (said,) = summary(found).believed
    assert plain(said.facts) == "width not told (error 110 N·m), probability 90%"
    assert "  dead_zone: width not told" in "\n".join(terminal_lines(found))
    assert "21" not in said.statement
    assert any(
        line.startswith("To learn the size of dead zone: ") for line in next_recordings(found, "joint")
    )
