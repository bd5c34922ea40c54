"""What a flight without position, velocity and attitude can be held against."""

from dataclasses import replace

import pytest
import torch

from simgap.diagnosis.observable import observable, unjudged
from simgap.diagnosis.regimes import regimes_of
from simgap.effects import effect_by_key
from simgap.gap.candidates import candidates_for
from simgap.gap.prepare import prepare
from simgap.gap.settings import Gap
from simgap.recordings.recording import Recording
from simgap.simulation import FittedEffect, Simulator
from tests.pipeline.gap.recordings import flown, racer

STATE = ("position", "attitude", "velocity")
LAG = FittedEffect(effect_by_key("quadrotor", "motor_lag"), {"time_constant": 0.03}, known=True)
DRAG = FittedEffect(effect_by_key("quadrotor", "rotor_drag"), {"coefficient": 0.3}, known=True)


def flight() -> Recording:
    """Return two short flights."""
    return flown((), seed=2, runs=2)


def without_state(recording: Recording, *more: str) -> Recording:
    """Return a recording as a flight controller would log it; `more` are columns that it lacks, too."""
    lost = [name for name in recording.frame if str(name).startswith((*STATE, "estimate_", *more))]
    return replace(recording, frame=recording.frame.drop(columns=lost))


def channels(recording: Recording) -> set[str]:
    prepared = prepare(recording, Simulator(racer()), Gap(), held=False)
    return {
        channel.name for channel in prepared.nominal.mechanism.channels_of(prepared.problem.blocks.signals)
    }


TORQUES = {"torque_x", "torque_y", "torque_z"}
ROTORS = {f"motor_speed_{n}" for n in range(1, 5)}


@pytest.mark.parametrize(
    ("lost", "expected"),
    [
        (("motor_speed", "specific_force"), TORQUES),
        (("motor_speed",), TORQUES | {"force_z"}),
        (("specific_force",), TORQUES | ROTORS),
    ],
)
def test_the_channels_are_those_that_the_columns_allow(lost, expected):
    assert channels(without_state(flight(), *lost)) == expected


def test_effects_of_speed_and_height_do_not_compete():
    prepared = prepare(without_state(flight(), "motor_speed"), Simulator(racer()), Gap(), held=False)
    signals = prepared.problem.blocks.signals
    chosen = {effect.key for effect in candidates_for(prepared.nominal, signals, None)}
    assert {"motor_lag", "battery_sag", "command_delay", "inertia_error", "center_of_mass_offset"} <= chosen
    assert not chosen & {
        "rotor_drag",
        "body_drag",
        "ground_effect",
        "steady_wind",
        "axial_inflow",
        "blade_flapping_moment",
    }
    inner = {name: prepared.problem.blocks.inner(series) for name, series in signals.items()}
    regimes = {regime.name for regime in regimes_of("quadrotor", prepared.nominal.along_time(inner, 0.01))}
    assert "turning_rate" in regimes
    assert not regimes & {"airspeed", "height", "velocity_x"}


def test_what_is_known_but_cannot_act_is_set_aside():
    recording, nominal = without_state(flight()), Simulator(racer(), (DRAG, LAG))
    kept, aside = observable(recording, nominal)
    assert kept.effects == (LAG,)
    assert aside == (DRAG,)
    assert "rotor_drag" in unjudged(aside)[0]
    assert observable(flight(), nominal) == (nominal, ())


def test_torques_without_a_state_are_those_with_it():
    """Of a body that turns the rates say everything about the torques."""
    whole = prepare(flight(), Simulator(racer()), Gap(), held=False)
    rates = prepare(without_state(flight()), Simulator(racer()), Gap(), held=False)
    residuals = [each.problem.residual(each.nominal) for each in (whole, rates)]
    names = [
        [channel.name for channel in each.nominal.mechanism.channels_of(each.problem.blocks.signals)]
        for each in (whole, rates)
    ]
    for name in TORQUES:
        pair = [residual[..., row.index(name)] for residual, row in zip(residuals, names, strict=True)]
        torch.testing.assert_close(*pair)
