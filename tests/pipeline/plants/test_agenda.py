"""Which cases a benchmark consists of."""

from collections import Counter
from itertools import islice

import pytest

from simgap.plants.agenda import CATEGORIES, subjects

TABLE = {
    "effects": {"drag": {}, "lag": {}, "friction@steer": {}, "mass_error": {}},
    "apart": [["drag", "lag"]],
    "hidden": [{"effect": "lag"}],
    "ambiguous": [{"effect": "drag"}, {"effect": "drag"}],
    "outside": {"gusts": {}},
}
EVEN = dict.fromkeys(CATEGORIES, 1.0)


def drawn(count, seed=0, table=TABLE, shares=EVEN):
    return list(islice(subjects(table, shares, seed), count))


def test_more_cases_continue_what_fewer_began():
    assert drawn(100)[:37] == drawn(37)


def test_every_seed_has_its_own_order():
    assert drawn(60, seed=1) == drawn(60, seed=1)
    assert drawn(60, seed=1) != drawn(60, seed=2)


def test_every_category_gets_its_share():
    shares = {"clear": 3.0, "faint": 2.0, "nothing": 1.0, "decoy": 1.0, "pair": 1.0}
    counted = Counter(subject.category for subject in drawn(80, shares=shares))
    assert counted == {"clear": 30, "faint": 20, "nothing": 10, "decoy": 10, "pair": 10}


def test_the_share_of_what_a_table_lacks_goes_to_the_others():
    counted = Counter(subject.category for subject in drawn(60, table={"effects": {"drag": {}, "lag": {}}}))
    assert counted == {"clear": 15, "faint": 15, "nothing": 15, "pair": 15}


def test_everything_comes_once_before_anything_comes_again():
    names = [subject.names[0] for subject in drawn(9, shares={"clear": 1.0})]
    for part in (names[:3], names[3:6], names[6:]):
        assert sorted(part) == ["drag", "friction@steer", "lag"]


def test_wrong_numbers_alone_are_decoys():
    subjects_ = drawn(200)
    alone = {s.names[0] for s in subjects_ if s.category in ("clear", "faint")}
    decoys = {(s.names[0], s.strength) for s in subjects_ if s.category == "decoy"}
    assert "mass_error" not in alone
    assert decoys == {("mass_error", "clear"), ("mass_error", "faint")}


def test_physics_and_wrong_numbers_are_mixed_with_what_has_no_name():
    mixed = {s.names for s in drawn(200) if s.category == "mixed"}
    assert mixed == {(name, "gusts") for name in TABLE["effects"]}


def test_pairs_leave_out_what_is_to_be_kept_apart():
    pairs = {frozenset(s.names) for s in drawn(200) if s.category == "pair"}
    assert frozenset({"drag", "lag"}) not in pairs
    assert len(pairs) == 5


@pytest.mark.parametrize("category", ["hidden", "ambiguous"])
def test_conditions_are_numbered_as_in_the_table(category):
    found = {s.condition for s in drawn(200) if s.category == category}
    assert found == set(range(len(TABLE[category])))


def test_without_shares_there_are_no_cases():
    assert drawn(5, shares={}) == []
