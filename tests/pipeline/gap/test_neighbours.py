"""What is proposed near a hypothesis: sets that together leave least."""

import functools

import torch

from simgap.effects import effect_by_key
from simgap.equations.fit import fit
from simgap.equations.presence import beginning
from simgap.equations.refit import extend
from simgap.gap.changes import changed_reading
from simgap.gap.hypothesis import Hypothesis, weigh
from simgap.gap.neighbours import Neighbours
from simgap.gap.reading import readings_of
from simgap.gap.settings import Gap
from simgap.simulation import FittedEffect, Simulator
from tests.pipeline.gap.recordings import flight, racer

SETTINGS = Gap(effects=["rotor_drag", "axial_inflow", "angular_drag", "gyroscopic_torque"])
BOTH = frozenset({"rotor_drag", "axial_inflow"})


@functools.cache
def around_nothing() -> tuple[Hypothesis, Neighbours]:
    recording = flight(("rotor_drag", 0.35), ("axial_inflow", 0.3))
    reading = readings_of(recording, Simulator(racer()), SETTINGS)[0]
    nothing = fit(reading.nominal, reading.problem)
    added = [
        weigh(extend(nothing, effect, reading.problem, reading.starts), reading)
        for effect in reading.catalogue
    ]
    centre = weigh(nothing, reading)
    return centre, Neighbours(centre, added, {})


def test_two_missing_effects_are_promised_most():
    centre, near = around_nothing()
    found = near.best(6, set())
    assert found[0].keys == BOTH
    assert found[0].promise > centre.score
    assert [each.promise for each in found] == sorted((each.promise for each in found), reverse=True)


def test_known_sets_are_not_proposed_again():
    _, near = around_nothing()
    assert BOTH not in [each.keys for each in near.best(6, {BOTH})]


def test_without_other_effects_nothing_is_proposed():
    centre, _ = around_nothing()
    assert Neighbours(centre, [], {}).best(6, set()) == []


def test_an_effect_that_was_known_before_goes_back_to_what_was_known():
    """It is there whatever the answer is: what a hypothesis without it has is the value of before."""
    effect = effect_by_key("quadrotor", "rotor_drag")
    known = FittedEffect(effect, {"coefficient": 0.2}, known=True)
    recording = flight(("rotor_drag", 0.35), ("axial_inflow", 0.3))
    reading = readings_of(recording, Simulator(racer(), (known,)), SETTINGS)[0]
    freed = extend(fit(reading.nominal, reading.problem), effect, reading.problem, reading.starts)
    near = Neighbours(weigh(freed, reading), [], {})
    back = reading.problem.residual(reading.nominal) - freed.residual
    found = near.gram[..., near.offset[effect.key], near.offset[effect.key]]
    torch.testing.assert_close(torch.from_numpy(found), back.square().mean(1)[near.part])


def test_beside_a_change_no_set_lacks_what_it_changes():
    reading = readings_of(flight(("rotor_drag", 0.35), ("axial_inflow", 0.3)), Simulator(racer()), SETTINGS)[
        0
    ]
    change = beginning(reading.problem.blocks, 2).joined_by("rotor_drag")
    reading = changed_reading(reading, change)
    drag = effect_by_key("quadrotor", "rotor_drag")
    centre = weigh(extend(fit(reading.nominal, reading.problem), drag, reading.problem), reading)
    added = [
        weigh(extend(centre.fit, effect, reading.problem, reading.starts), reading)
        for effect in reading.catalogue
        if effect.key != drag.key
    ]
    found = Neighbours(centre, added, {}).best(20, set())
    assert found
    assert all(drag.key in each.keys for each in found)


def test_what_is_usual_shrinks_with_what_is_left():
    _, near = around_nothing()
    scaled = near._scaled(0.25 * near.left + 1e6 * near.noise)
    usual = near._scaled(near.left + 4e6 * near.noise).usual
    torch.testing.assert_close(scaled.usual, 0.25 * usual)
