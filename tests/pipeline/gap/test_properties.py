"""What may not change an answer: units, orders, and effects that have nothing to do with it."""

import functools
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from simgap.gap.name import Naming, name
from simgap.gap.reading import readings_of
from simgap.gap.settings import Gap
from simgap.platforms import Joint
from simgap.recordings.recording import Recording
from simgap.simulation import Simulator
from tests.pipeline.gap.recordings import Plant, joint_recordings, joint_simulator
from tests.pipeline.gap.units import driven_by_effort, in_units

pytestmark = pytest.mark.slow

TOLERANCE = 0.02  # of probability
FEW = (
    "coulomb_friction",
    "viscous_friction",
    "constant_load",
    "command_delay",
    "linear_stiffness",
    "dead_zone",
    "inertia_error",
)
PLANTS = {
    "friction": Plant(friction=0.3, viscous=0.04),
    "load": Plant(friction=0.1, other=lambda q, v: 0.2 + 0.0 * q),
    "inertia": Plant(inertia=1.2),
    "unknown": Plant(other=lambda q, v: 0.15 * np.sin(3.0 * q) * v),
    "nothing": Plant(),
}


@functools.cache
def recorded(plant: str) -> tuple[Recording, Simulator]:
    return joint_recordings(PLANTS[plant], [0], runs=4, duration=4.0)[0], joint_simulator()


@functools.cache
def answer(plant: str, effort: bool = False) -> Naming:
    recording, simulator = recorded(plant)
    return named(*(driven_by_effort(recording) if effort else (recording, simulator)))


def named(recording: Recording, simulator: Simulator, effects: tuple[str, ...] = FEW) -> Naming:
    settings = Gap(effects=list(effects))
    return name(readings_of(recording, simulator, settings), settings)


def assert_same(found: Naming, expected: Naming, but: frozenset[str] = frozenset()) -> None:
    """Assert that names and probabilities are the same, but for some effects."""
    assert [n.effect.key for n in found.named if n.effect.key not in but] == [
        n.effect.key for n in expected.named
    ]
    every = set(found.probabilities) | set(expected.probabilities)
    differences = {
        key: (expected.probabilities.get(key, 0.0), found.probabilities.get(key, 0.0)) for key in every - but
    }
    wrong = {key: pair for key, pair in differences.items() if abs(pair[0] - pair[1]) > TOLERANCE}
    assert not wrong, wrong
    assert found.complete == expected.complete


def in_millivolts(recording: Recording, simulator: Simulator) -> tuple[Recording, Simulator]:
    """Return what a motor's joint looks like in mV, mΩ, mN·m and g·m²: the current stays in A."""
    platform, size = simulator.platform, 1e3
    assert isinstance(platform, Joint)
    assert platform.motor is not None
    motor = replace(
        platform.motor,
        resistance=size * platform.motor.resistance,
        torque_constant=size * platform.motor.torque_constant,
    )
    frame = recording.frame.assign(voltage=size * recording.frame["voltage"])
    scaled = replace(platform, motor=motor, inertia=size * platform.inertia)
    return replace(recording, frame=frame), replace(simulator, platform=scaled)


UNITS: dict[str, Callable[[Recording, Simulator], tuple[Recording, Simulator]]] = {
    "millinewtons": functools.partial(in_units, effort=1e3),
    "kilonewtons": functools.partial(in_units, effort=1e-3),
    "degrees": functools.partial(in_units, travel=180.0 / np.pi),
    "kilometres": functools.partial(in_units, travel=1e-3),
}


@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize("plant", PLANTS)
def test_units_of_a_joint_driven_by_an_effort(plant, unit):
    scaled = UNITS[unit](*driven_by_effort(recorded(plant)[0]))
    assert_same(named(*scaled), answer(plant, effort=True))


@pytest.mark.parametrize("plant", PLANTS)
def test_units_of_a_joint_driven_by_a_voltage(plant):
    assert_same(named(*in_millivolts(*recorded(plant))), answer(plant))


@pytest.mark.parametrize("plant", PLANTS)
def test_the_order_of_columns_and_runs_and_what_runs_are_called(plant):
    """All at once: the last run comes first and under another name, and its last column before the others."""
    recording, simulator = recorded(plant)
    parts = [part for _, part in recording.frame.groupby("run", sort=False)]
    frame = pd.concat(parts[::-1], ignore_index=True)[list(recording.frame.columns)[::-1]]
    frame["run"] = "trial " + frame["run"].str[::-1]
    split = {"trial " + run[::-1]: part for run, part in recording.split.items()}
    assert_same(named(replace(recording, frame=frame, split=split), simulator), answer(plant))


@pytest.mark.parametrize("plant", PLANTS)
def test_the_order_of_effects(plant):
    recording, simulator = recorded(plant)
    settings = Gap(effects=list(FEW))
    readings = [replace(r, catalogue=r.catalogue[::-1]) for r in readings_of(recording, simulator, settings)]
    assert_same(name(readings, settings), answer(plant))


IRRELEVANT = ("cogging", "quadratic_friction", "cubic_stiffness", "hysteresis")


@pytest.mark.parametrize("plant", [plant for plant in PLANTS if plant != "unknown"])
def test_effects_that_are_not_there_added_to_the_catalogue(plant):
    found = named(*recorded(plant), (*FEW, *IRRELEVANT))
    assert_same(found, answer(plant), frozenset(IRRELEVANT))
    assert sum(found.probabilities.get(key, 0.0) for key in IRRELEVANT) < 0.15
