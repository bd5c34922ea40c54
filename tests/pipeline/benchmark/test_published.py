"""Published recordings against what is known of them."""

import pytest

from simgap.benchmark.published import published_rows, score_published


def diagnosis(**named):
    effects = [
        {"name": n, "probability": p, "parameters": {"level": {"value": v}}} for n, (p, v) in named.items()
    ]
    fit = {"gap_closed": 0.8, "gap_closed_interval": [0.7, 0.9]}
    return {"diagnosis": {"effects": effects, "verdict": "missing_physics", "fit": fit}, "seconds": 12.0}


KNOWN = {"effects": ["friction|stiction", "backlash"], "values": {"friction": {"level": 2.0}}}


def test_one_of_several_names_is_enough_and_all_entries_are_wanted():
    score = score_published(KNOWN, diagnosis(friction=(0.9, 2.2), cogging=(0.8, 1.0)))
    assert (score["found"], score["missed"], score["first_known"]) == (
        ["friction|stiction"],
        ["backlash"],
        True,
    )
    assert score["errors"] == {"friction.level": pytest.approx(0.1)}


def test_what_is_not_believed_is_not_found():
    score = score_published(KNOWN, diagnosis(backlash=(0.3, 1.0)))
    assert (score["found"], score["first"]) == ([], "backlash")


def test_what_shares_its_probability_with_rivals_is_said_with_them():
    answer = diagnosis(friction=(0.45, 2.0))
    answer["diagnosis"]["ambiguous"] = [{"names": ["friction", "load"], "separate_by": "Turn round."}]
    doubted = score_published(KNOWN, answer | {"posterior": {"friction": 0.45}})
    assert (doubted["undecided"], doubted["missed"]) == ({}, KNOWN["effects"])
    score = score_published(KNOWN, answer | {"posterior": {"friction": 0.45, "load": 0.4}})
    assert (score["found"], score["undecided"], score["missed"]) == (
        [],
        {"friction|stiction": ["load"]},
        ["backlash"],
    )
    (row,) = published_rows([{"branch": "arm", "score": score} | answer])
    assert row[1] == "`friction|stiction` found, but not told from `load`, `backlash` **missed**"


def test_what_was_taken_out_has_to_come_back_first():
    ablated = {
        "friction": diagnosis(friction=(0.9, 2.0)),
        "backlash": diagnosis(cogging=(0.9, 1.0), backlash=(0.8, 1.0)),
    }
    score = score_published(KNOWN, diagnosis(friction=(0.9, 2.0)) | {"ablated": ablated})
    assert score["restored"] == {"friction": True, "backlash": False}


def test_a_recording_that_cannot_be_diagnosed_is_said():
    answer = {"failed": "InputError: the recordings cannot be reached"}
    score = score_published(KNOWN, answer)
    assert score["missed"] == KNOWN["effects"]
    (row,) = published_rows([{"branch": "arm", "score": score} | answer])
    assert row[2] == "failed: InputError: the recordings cannot be reached"


def test_a_row_says_what_is_known_found_and_restored():
    answer = diagnosis(friction=(0.9, 2.2)) | {"ablated": {"friction": diagnosis(friction=(0.9, 2.0))}}
    answer |= {"explained": {"named": 0.5, "flexible": 0.6}}
    (row,) = published_rows([{"branch": "arm", "score": score_published(KNOWN, answer)} | answer])
    assert row == [
        "arm",
        "`friction|stiction` found (off by 10%), `backlash` **missed**",
        "`friction` 0.90",
        "80% (70%–90%)",
        "50%, 60%",
        "`friction` back",
        "12",
    ]


def test_one_held_out_run_has_no_interval():
    answer = diagnosis(backlash=(0.9, 1.0)) | {"branch": "servo"}
    answer["score"] = score_published(KNOWN, answer)
    answer["diagnosis"]["fit"]["gap_closed_interval"] = None
    assert published_rows([answer])[0][3] == "80% (one run: no interval)"


@pytest.mark.parametrize(
    ("explained", "enough"),
    [(None, False), ({"named": 0.5, "flexible": 0.6}, True), ({"named": 0.4, "flexible": 0.6}, False)],
)
def test_names_have_to_explain_most_of_what_can_be_explained(explained, enough):
    answer = diagnosis(friction=(0.9, 2.0)) | {"explained": explained}
    assert score_published(KNOWN, answer)["explained_enough"] == enough
