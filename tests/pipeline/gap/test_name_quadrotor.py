"""Flights of the concealed plant, which is richer than the catalogue and flown in closed loop with noisy sensors."""

import functools
from dataclasses import replace

import pytest

from simgap.diagnosis.diagnose import Diagnosis
from simgap.recordings.recording import Recording
from simgap.simulation import Simulator
from tests.pipeline.gap.problems import named, quick, value_of
from tests.pipeline.gap.recordings import flight, held_flights, late, racer, uneventful_flights

pytestmark = pytest.mark.slow

PLANTED = {"rotor_drag": 0.35, "body_drag": 0.03, "axial_inflow": 0.3, "translational_lift": 0.02}


@pytest.mark.parametrize("name", PLANTED)
def test_the_concealed_effect_is_named_and_no_other(name):
    found = quick(flight((name, PLANTED[name])), Simulator(racer()))
    assert found.verdict == "missing_physics"
    assert named(found) == [name]
    assert found.probabilities[name] > 0.5
    assert found.naming.posterior.inclusion()[name] > 0.9
    assert value_of(found, name) == pytest.approx(PLANTED[name], rel=0.1)
    assert found.validation.gap_closed is not None
    assert found.validation.gap_closed > 0.9


def test_both_of_a_pair_are_named():
    found = quick(flight(("rotor_drag", 0.35), ("axial_inflow", 0.3)), Simulator(racer()))
    assert set(named(found)) == {"rotor_drag", "axial_inflow"}
    assert value_of(found, "rotor_drag") == pytest.approx(0.35, rel=0.1)
    assert value_of(found, "axial_inflow") == pytest.approx(0.3, rel=0.1)


def test_nothing_is_named_where_nothing_is_concealed():
    """Four recordings of eight flights each: none is wrong here."""
    for recording in uneventful_flights():
        found = quick(recording, Simulator(racer()))
        assert (found.verdict, named(found), found.unnamed) == ("none", [], [])


@pytest.mark.parametrize("samples", [2, -2])
def test_a_late_or_early_state_is_named(samples):
    found = quick(late(uneventful_flights()[0], samples), Simulator(racer()))
    assert named(found) == ["sensor_time_offset"]
    assert value_of(found, "sensor_time_offset") == pytest.approx(0.01 * samples, rel=0.1)


def blown(recording: Recording, wind_x: float, wind_y: float) -> Recording:
    """Return the flights as they look from ground below which the still air moves: the same flights in a wind, m/s."""
    frame = recording.frame.copy()
    since = frame["t"] - frame.groupby("run")["t"].transform("min")
    for axis, speed in (("x", wind_x), ("y", wind_y)):
        frame[f"velocity_{axis}"] += speed
        frame[f"position_{axis}"] += speed * since
    return replace(recording, frame=frame)


@functools.cache
def in_a_wind() -> Diagnosis:
    """Return the diagnosis of flights in a wind of 3 and −1.5 m/s that pushes through the drag of the rotors."""
    return quick(blown(flight(("rotor_drag", 0.35)), 3.0, -1.5), Simulator(racer()))


def test_a_wind_is_named_beside_the_drag_through_which_it_pushes():
    found = in_a_wind()
    assert set(named(found)) == {"rotor_drag", "steady_wind"}
    assert value_of(found, "rotor_drag") == pytest.approx(0.35, rel=0.1)


def test_the_speed_of_the_wind_is_its_push_over_the_drag():
    found = in_a_wind()
    (wind,) = (f for f in found.simulator.effects if f.effect.key == "steady_wind")
    drag = value_of(found, "rotor_drag")
    assert wind.values["push_x"] / drag == pytest.approx(3.0, rel=0.1)
    assert wind.values["push_y"] / drag == pytest.approx(-1.5, rel=0.1)


def acts_half_a_sample_late(found: Diagnosis) -> bool:
    """Whether commands are taken to be held, or to come as much later as holding delays them on average."""
    constants, step = found.simulator.constants(), found.fitting.blocks.time_step
    effects = [f for f in found.simulator.effects if f.effect.key not in named(found)]
    late = sum(f.effect.lateness(f.values, constants) for f in effects)
    return late / step == pytest.approx(0.0 if found.fitting.blocks.held else 0.5, abs=0.15)


def test_commands_that_are_held_to_the_next_sample_are_not_called_late():
    """Read at their instants, they act half a sample too late: that was a command delay of 6 ms, probability 0.99."""
    contestants = ["motor_lag", "command_delay", "sensor_time_offset", "thrust_coefficient_error"]
    found = quick(held_flights(0.03), Simulator(racer()), contestants)
    assert named(found) == ["motor_lag"]
    assert value_of(found, "motor_lag") == pytest.approx(0.03, rel=0.03)
    assert acts_half_a_sample_late(found)


def test_a_lag_of_half_a_sample_is_that_of_a_held_command():
    found = quick(held_flights(0.0), Simulator(racer()), ["motor_lag", "thrust_coefficient_error"])
    assert named(found) == []
    assert acts_half_a_sample_late(found)


@pytest.mark.parametrize(
    ("key", "ratio", "name"),
    [
        ("mass", 1.15, "mass_error"),
        ("thrust_coefficient", 0.9, "thrust_coefficient_error"),
        ("inertia", 0.85, "inertia_error"),
        ("torque_coefficient", 1.3, "torque_coefficient_error"),
    ],
)
def test_a_wrong_number_of_the_platform_is_named(key, ratio, name):
    """The plant is right and the platform file is wrong: the ratio is true over nominal."""
    true = getattr(racer(), key)
    wrong = tuple(value / ratio for value in true) if isinstance(true, tuple) else true / ratio
    found = quick(uneventful_flights()[0], Simulator(replace(racer(), **{key: wrong})))
    assert found.verdict == "parameter_mismatch"
    assert named(found) == [name]
    assert value_of(found, name) == pytest.approx(ratio, rel=0.1)
