"""Random machines, conditions and magnitudes."""

import math

import numpy as np
import pytest

from simgap.errors import InputError
from simgap.plants.concealment import Quantity
from simgap.plants.draw import draw_conditions, draw_effect, merged, vary_platform

AROUND = 0.2


def effects(quantities, defaults, draws=300):
    random = np.random.default_rng(0)
    return [draw_effect(quantities, defaults, AROUND, random) for _ in range(draws)]


def test_conditions_lie_between_their_bounds_or_in_their_list():
    table = {
        "runs": {"from": 5, "to": 7},
        "speed": {"from": 0.5, "to": 2.0},
        "dropped": {"from": 0.0, "to": 0.1},
        "held": {"one_of": [True, False]},
        "kind": "varied",
        "sensors": {"scale": {"from": 0.7, "to": 1.4}},
    }
    random = np.random.default_rng(0)
    drawn = [draw_conditions(table, random) for _ in range(200)]
    assert {entry["runs"] for entry in drawn} == {5, 6, 7}
    assert {entry["held"] for entry in drawn} == {True, False}
    assert all(0.5 <= entry["speed"] <= 2.0 and 0.0 <= entry["dropped"] <= 0.1 for entry in drawn)
    assert all(0.7 <= entry["sensors"]["scale"] <= 1.4 for entry in drawn)
    assert {entry["kind"] for entry in drawn} == {"varied"}


def test_a_range_from_positive_bounds_is_even_in_its_logarithm():
    random = np.random.default_rng(0)
    logs = [math.log(draw_conditions({"x": {"from": 0.01, "to": 1.0}}, random)["x"]) for _ in range(4000)]
    assert np.mean(logs) == pytest.approx(math.log(0.1), abs=0.07)


def test_a_range_the_wrong_way_round_is_refused():
    with pytest.raises(InputError, match=r"conditions\.speed: from 2\.0 to 1\.0 is no range"):
        draw_conditions({"speed": {"from": 2.0, "to": 1.0}}, np.random.default_rng(0))


def test_a_machines_own_conditions_go_before_the_common_ones():
    common = {"runs": 5, "sensors": {"scale": 1.0, "position": 1e-3}}
    own = {"sensors": {"position": 1e-5}, "sliding": True}
    assert merged(common, own) == {"runs": 5, "sensors": {"scale": 1.0, "position": 1e-5}, "sliding": True}


def test_machines_are_varied_only_where_the_table_says():
    machines = {"a": {"mass": 1.0, "inertia": [1.0, 2.0], "name": "a"}}
    name, told = vary_platform(machines, {"inertia": 0.3, "stiffness": 0.3}, np.random.default_rng(1))
    assert (name, told["mass"], told["name"], set(told)) == ("a", 1.0, "a", {"mass", "inertia", "name"})
    factor = told["inertia"][0]
    assert factor != 1.0
    assert abs(math.log(factor)) <= 0.3
    assert told["inertia"][1] == pytest.approx(2.0 * factor)
    assert machines["a"]["inertia"] == [1.0, 2.0]


def test_a_magnitude_lies_around_its_default_and_keeps_its_sign():
    values = [entry["level"] for entry in effects({"level": Quantity("N", 2.0)}, {"level": 2.0})]
    assert 2.0 * math.exp(-AROUND) <= min(values) < 1.8
    assert 2.2 < max(values) <= 2.0 * math.exp(AROUND)


def test_what_may_have_either_sign_has_either():
    values = [
        entry["offset"] for entry in effects({"offset": Quantity("s", 0.02, low=-1.0)}, {"offset": 0.02})
    ]
    assert 0.3 < np.mean(np.sign(values)) / 2 + 0.5 < 0.7


def test_a_wrong_number_may_be_too_great_or_too_small():
    quantities = {"ratio": Quantity("1", 1.2, neutral=1.0, low=0.1)}
    values = [entry["ratio"] for entry in effects(quantities, {"ratio": 1.2})]
    assert min(values) < 1 / 1.15
    assert max(values) > 1.15
    assert all(0.1 < abs(math.log(value)) < 0.3 for value in values)


def test_a_direction_is_drawn_evenly_and_keeps_its_length():
    quantities = {"wind_x": Quantity("m/s", 4.0, low=-30.0), "wind_y": Quantity("m/s", 0.0, low=-30.0)}
    winds = np.array([list(entry.values()) for entry in effects(quantities, {"wind_x": 4.0, "wind_y": 0.0})])
    lengths = np.hypot(*winds.T)
    assert lengths.min() > 4.0 * math.exp(-AROUND) - 1e-9
    assert lengths.max() < 4.0 * math.exp(AROUND) + 1e-9
    assert np.abs(winds.mean(0)).max() < 0.8


def test_only_one_of_several_that_cannot_be_negative_is_hit():
    quantities = {f"loss_{i}": Quantity("1", 0.2 if i == 1 else 0.0, high=0.6) for i in range(1, 5)}
    drawn = effects(quantities, {name: quantity.default for name, quantity in quantities.items()})
    hit = [[name for name, value in entry.items() if value > 0] for entry in drawn]
    assert {len(names) for names in hit} == {1}
    assert {names[0] for names in hit} == set(quantities)


def test_values_stay_within_what_makes_sense():
    values = [entry["drop"] for entry in effects({"drop": Quantity("1", 0.5, high=0.51)}, {"drop": 0.5})]
    assert max(values) == 0.51
