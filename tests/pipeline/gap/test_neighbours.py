"""What is proposed near a hypothesis: sets that together leave least."""

import functools

import torch

from simgap.equations.fit import fit
from simgap.equations.refit import extend
from simgap.gap.hypothesis import Hypothesis, weigh
from simgap.gap.neighbours import Neighbours
from simgap.gap.reading import readings_of
from simgap.gap.settings import Gap
from simgap.simulation import Simulator
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


def test_what_is_usual_shrinks_with_what_is_left():
    _, near = around_nothing()
    scaled = near._scaled(0.25 * near.left + 1e6 * near.noise)
    usual = near._scaled(near.left + 4e6 * near.noise).usual
    torch.testing.assert_close(scaled.usual, 0.25 * usual)
