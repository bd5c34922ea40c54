"""Cases of the benchmark as they are drawn from the tables of `conf/prove`."""

import hashlib

import pytest

from simgap.errors import InputError
from simgap.plants import case_from_config
from simgap.plants.agenda import CATEGORIES
from simgap.plants.concealed import KINDS, draw_cases, record_concealed
from simgap.plants.sealing import key_text
from simgap.platforms import platform_from_config
from simgap.runner.compose import compose

PROVE = compose([])["prove"]
MACHINES = {
    kind: {name: compose([f"platform={name}"])["platform"] for name in PROVE[kind]["machines"]}
    for kind in KINDS
}


def drawn(kind, count, seed=5, **shares):
    return draw_cases(kind, PROVE[kind], shares or PROVE["shares"], MACHINES[kind], seed, count)


@pytest.mark.parametrize("kind", KINDS)
def test_every_drawn_case_can_be_recorded_on_the_machine_it_tells_of(kind):
    cases = drawn(kind, 150)
    assert {case.subject.category for case in cases} == set(CATEGORIES)
    for case in cases:
        assert platform_from_config(case.platform).kind == kind
        case_from_config(kind, case.record).check()


@pytest.mark.parametrize("kind", KINDS)
def test_cases_are_reproducible_and_differ_from_each_other(kind):
    assert drawn(kind, 40)[:15] == drawn(kind, 15)
    assert len({case.seed for case in drawn(kind, 40)}) == 40
    assert drawn(kind, 5, seed=6) != drawn(kind, 5, seed=5)


def test_every_effect_of_the_tables_can_be_drawn_alone():
    for kind in KINDS:
        table = PROVE[kind]["effects"]
        errors = {name for name in table if name.partition("@")[0].endswith("_error")}
        twins = {name for name, entry in table.items() if "twin" in entry}
        alone = drawn(kind, len(table) - len(errors | twins), clear=1.0)
        assert {case.subject.names[0] for case in alone} == set(table) - errors - twins
        for case in alone:
            assert set(case.record["effects"]) >= set(case.subject.names)


def test_an_effect_with_a_twin_is_ambiguous_and_nothing_else():
    twins = {name for name, entry in PROVE["joint"]["effects"].items() if "twin" in entry}
    assert twins
    cases = drawn("joint", 150, **dict.fromkeys(("clear", "faint", "pair", "mixed", "ambiguous"), 0.2))
    found = {case.subject.category for case in cases if twins & set(case.subject.names)}
    assert found == {"ambiguous"}


def test_a_null_conceals_nothing():
    for case in drawn("joint", 4, nothing=1.0):
        assert "effects" not in case.record
        assert "outside" not in case.record


def test_what_shows_only_beside_another_is_drawn_with_it():
    (case,) = [case for case in drawn("quadrotor", 21, clear=1.0) if case.subject.names == ("steady_wind",)][
        :1
    ]
    assert set(case.record["effects"]) == {"steady_wind", "body_drag"}
    assert case.wanted == ("steady_wind",)


def test_effects_that_begin_later_begin_in_the_middle_of_the_same_case():
    firsts = []
    for case in drawn("joint", 8, clear=1.0):
        later = case.begun_later
        runs = case_from_config("joint", later.record).runs
        firsts.append(later.record["begins_in_run"])
        assert 2 <= firsts[-1] < runs
        assert {**later.record, "begins_in_run": 1} == {**case.record, "begins_in_run": 1}
    assert len(set(firsts)) > 1


@pytest.mark.slow
def test_a_concealed_driver_is_not_recorded():
    short = PROVE["quadrotor"]["conditions"] | {"runs": 2, "duration": 1.0}
    table = PROVE["quadrotor"] | {"conditions": short}
    for case in draw_cases("quadrotor", table, {"hidden": 1.0}, MACHINES["quadrotor"], 5, 6):
        assert case.hiding["hidden"]
        shown, hidden = (record_concealed(c)[0].frame for c in (case.shown, case))
        assert set(shown) - set(hidden)


@pytest.mark.parametrize("kind", KINDS)
def test_some_machine_can_conceal_whatever_pair_is_drawn(kind):
    every = len(PROVE[kind]["effects"]) ** 2 // 2  # cards are drawn in turn, all before one comes again
    pairs = {frozenset(case.subject.names) for case in drawn(kind, every, pair=1.0)}
    assert not pairs & {frozenset(pair) for pair in PROVE[kind]["apart"]}


def test_effects_that_no_machine_has_together_are_refused():
    table = PROVE["joint"] | {
        "effects": {
            "coulomb_friction": {"machines": ["servo"]},
            "viscous_friction": {"machines": ["pendulum"]},
        }
    }
    with pytest.raises(InputError, match="keep such effects `apart`"):
        draw_cases("joint", table, {"pair": 1.0}, MACHINES["joint"], 1, 1)


def test_a_kind_that_there_is_not_is_refused():
    with pytest.raises(InputError, match="unknown kind 'boat'"):
        draw_cases("boat", PROVE["joint"], PROVE["shares"], {}, 1, 1)


def test_a_recording_names_the_hash_of_its_key_and_nothing_else_of_it():
    table = PROVE["joint"] | {"conditions": PROVE["joint"]["conditions"] | {"runs": 2, "duration": 1.0}}
    (case,) = draw_cases("joint", table, {"clear": 1.0}, MACHINES["joint"], 1, 1)
    recording, key = record_concealed(case)
    assert [effect["name"] for effect in key["effects"]] == list(case.subject.names)
    assert hashlib.sha256(key_text(key).encode()).hexdigest() in recording.source
    assert case.subject.names[0] not in recording.source
