"""Scans of effects, and what a regression around their best points promises."""

import functools

import pytest
import torch

from simgap.effects import effect_by_key
from simgap.gap.fit import fit
from simgap.gap.reading import Reading, readings_of
from simgap.gap.refit import extend
from simgap.gap.settings import Gap
from simgap.gap.starts import Starts
from simgap.simulation import FittedEffect, Simulator
from tests.pipeline.gap.recordings import Plant, flight, joint_recording, joint_simulator, racer


@functools.cache
def joint(**plant: float) -> Reading:
    """Read with held commands: measured ones would be late by half a sample."""
    return readings_of(joint_recording(Plant(**plant)), joint_simulator(), Gap())[1]


@functools.cache
def flown() -> Reading:
    return readings_of(flight(), Simulator(racer()), Gap())[0]


@pytest.mark.parametrize(
    ("reading", "name"),
    [
        (joint, "cogging"),
        (joint, "linear_stiffness"),
        (flown, "steady_wind"),
        (flown, "rotor_drag"),
        (flown, "center_of_mass_offset"),
    ],
)
def test_a_load_does_what_a_simulator_with_it_shows(reading, name):
    """It is worked out alone; here the whole simulator is evaluated with it and without it."""
    starts: Starts = reading().starts
    effect = effect_by_key(starts.nominal.platform.kind, name)
    values = effect.defaults()
    moved = starts.nominal.with_effects((FittedEffect(effect, values),))
    shown = starts.few.residual(starts.nominal) - starts.few.residual(moved)
    assert float(shown.abs().max()) > 0.0
    torch.testing.assert_close(starts._load_at(effect, values).taken, shown, rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize(
    ("name", "plant"),
    [("command_delay", {"delay": 0.025}), ("current_limit", {"current_limit": 5.0})],
)
def test_what_is_there_promises_what_a_fit_of_it_gains_and_what_is_not_there_nothing(name, plant):
    effect = effect_by_key("joint", name)
    for reading, is_there in ((joint(**plant), True), (joint(), False)):
        nominal = fit(reading.nominal, reading.problem)
        gained = [
            -reading.problem.cost(each.residual, each.simulator)
            for each in (nominal, extend(nominal, effect, reading.problem, reading.starts))
        ]
        promised = reading.starts.promise(effect, nominal)
        assert (promised > 0.5) == is_there
        assert promised > 0.3 * (gained[1] - gained[0]) - 0.5


def test_both_timings_share_their_scans():
    first, second = readings_of(joint_recording(Plant()), joint_simulator(), Gap())
    assert second.starts is first.starts
