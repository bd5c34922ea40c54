"""Servos that are told a position: gains that nobody gave, velocities that nobody recorded, and what is named."""

from dataclasses import replace

import pytest
import torch

from simgap.diagnosis.diagnose import Diagnosis
from simgap.equations.derived_noise import noise_of_derived
from simgap.equations.residuals import residual_rows
from simgap.gap.gains import IdentifiedGain, folded, gain_remarks, with_gains
from simgap.gap.settings import Gap
from simgap.physics.weak_form import window_functions
from simgap.plants import record_case
from simgap.plants.joint.case import JointCase, JointSensors
from simgap.platforms import Controller, Joint
from simgap.recordings.cleaning import clean_recording
from simgap.recordings.recording import Recording
from simgap.recordings.split import Split
from simgap.simulation import FittedEffect, Simulator
from simgap.simulation.blocks import cut_blocks
from tests.pipeline.gap.problems import named, quick, value_of

PLATFORM = Joint(inertia=0.03, gravity_torque=0.6, controller=Controller(12.0, 0.6, 3.0))
UNKNOWN = replace(PLATFORM, controller=None)


def recorded(effects: dict[str, dict[str, float]], runs: int = 4, **changed) -> Recording:
    """Return a servo's targets and positions at 100 Hz, with a velocity that was derived."""
    usual = {"rate": 100.0, "amplitude": 1.0, "velocity": 4.0, "acceleration": 30.0, "held": True}
    usual |= {"without": ["velocity"], "sensors": JointSensors(position_step=1.5e-3)}
    case = JointCase(effects=effects, runs=runs, duration=4.0, **usual | changed)
    recording, _ = record_case(case, PLATFORM, seed=3)
    return clean_recording(recording, split=Split(holdout=[recording.runs[-1]]))[0]


@pytest.fixture(scope="module")
def plain() -> Recording:
    return recorded({})


def gains_of(simulator: Simulator) -> Controller:
    assert isinstance(simulator.platform, Joint)
    assert simulator.platform.controller is not None
    return simulator.platform.controller


def test_first_estimates_lead_the_axis_as_the_true_gains_do(plain):
    nominal = with_gains(plain, Simulator(UNKNOWN), Gap())
    controller = gains_of(nominal)
    assert controller.proportional == pytest.approx(12.0, rel=0.15)
    assert controller.derivative == pytest.approx(0.6, rel=0.15)
    assert controller.given == ()
    assert {f.effect.key for f in nominal.free} == {"identified_proportional", "identified_derivative"}
    assert all("was not given; it was identified as" in remark for remark in gain_remarks(nominal, nominal))


def test_a_gain_that_is_given_is_kept(plain):
    half = replace(PLATFORM, controller=Controller(proportional=12.0))
    nominal = with_gains(plain, Simulator(half), Gap())
    controller = gains_of(nominal)
    assert (controller.proportional, controller.proportional_std) == (12.0, None)
    assert controller.derivative == pytest.approx(0.6, rel=0.1)
    assert [f.effect.key for f in nominal.free] == ["identified_derivative"]
    assert with_gains(plain, Simulator(PLATFORM), Gap()).free == ()


def test_an_effort_that_was_recorded_needs_no_gains(plain):
    frame = plain.frame.assign(effort=0.0)
    driven = replace(plain, frame=frame, units=plain.units | {"effort": "N·m"})
    assert with_gains(driven, Simulator(UNKNOWN), Gap()) == Simulator(UNKNOWN)


def test_a_limit_alone_of_a_loop_that_nobody_asked_says_nothing_of_gains(plain):
    """A URDF file gives the limit of a joint's effort, whatever drives it."""
    limited = Simulator(replace(PLATFORM, controller=Controller(effort_limit=3.0)))
    assert gain_remarks(folded(limited), limited) == []


def test_identified_gains_become_numbers_of_the_platform():
    estimated = replace(PLATFORM, controller=Controller(10.0, 0.5, None, 1.0, 0.1))
    ratios = {"proportional": 1.2, "derivative": 0.9}
    free = tuple(FittedEffect(IdentifiedGain(g), {"ratio": r}, {"ratio": 0.02}) for g, r in ratios.items())
    found = gains_of(folded(Simulator(estimated, free)))
    assert (found.proportional, found.derivative) == (12.0, 0.45)
    assert (found.proportional_std, found.derivative_std) == pytest.approx((0.2, 0.01))
    assert folded(Simulator(estimated)) == Simulator(estimated)


@pytest.mark.parametrize("held", [False, True])
def test_the_noise_of_a_derived_velocity_is_what_the_rows_have(plain, held):
    """White noise is added to the position alone; the velocity is its slope, as it is where nobody recorded one."""
    simulator = Simulator(PLATFORM)
    quiet = recorded({}, runs=2, dropped=0.0, sensors=JointSensors(scale=0.0))
    noisy = recorded({}, runs=2, dropped=0.0, sensors=JointSensors(position=5e-3, position_step=0.0))
    first, second = (cut_blocks(each, PLATFORM, 1.0, 0.5, held=held) for each in (quiet, noisy))
    functions = window_functions(first.samples, 0.2, first.time_step)
    rows = residual_rows(simulator, second, functions) - residual_rows(simulator, first, functions)
    size = rows.square().mean((0, 1)).sqrt()
    torch.testing.assert_close(noise_of_derived(simulator, second, functions), size, rtol=0.25, atol=0.0)


def told(diagnosis: Diagnosis, *words: str) -> bool:
    return any(all(word in warning for word in words) for warning in diagnosis.warnings)


@pytest.mark.slow
def test_friction_is_named_beside_gains_that_nobody_gave_and_viscous_friction_is_one_of_them():
    concealed = {"coulomb_friction": {"level": 0.12}, "viscous_friction": {"coefficient": 0.1}}
    names = [*concealed, "command_delay", "gravity_load"]
    found = quick(recorded(concealed), Simulator(UNKNOWN), names)
    assert named(found) == ["coulomb_friction"]
    assert value_of(found, "coulomb_friction") == pytest.approx(0.12, rel=0.1)
    controller = gains_of(found.simulator)
    assert controller.proportional == pytest.approx(12.0, rel=0.15)  # of nine seconds
    assert controller.derivative == pytest.approx(0.7, rel=0.15)
    assert told(found, "controller.proportional was not given", "first estimate")
    assert told(found, "cannot tell viscous friction from another derivative gain", "log the effort")


@pytest.mark.slow
def test_gains_that_are_given_may_be_wrong_and_commands_late():
    concealed = {
        "controller_gain_error": {"proportional": 1.3, "derivative": 1.2},
        "command_delay": {"delay": 0.04},
    }
    found = quick(recorded(concealed), Simulator(PLATFORM), [*concealed, "coulomb_friction", "gravity_load"])
    assert set(named(found)) == set(concealed)
    values = {f.effect.key: f.values for f in found.simulator.effects}
    assert values["controller_gain_error"] == pytest.approx(concealed["controller_gain_error"], rel=0.05)
    assert values["command_delay"] == pytest.approx({"delay": 0.04}, rel=0.05)
