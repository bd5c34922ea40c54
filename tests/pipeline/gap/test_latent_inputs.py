"""Slow drivers that were not recorded."""

import functools
from dataclasses import replace

import numpy as np
import pytest
import torch

from simgap.gap.driver_law import DriverLaw, constant, lagged, with_signal
from simgap.gap.latent_inputs import undriven
from simgap.simulation import FittedEffect
from tests.pipeline.gap import recordings
from tests.pipeline.gap.problems import named, problem_of, quick
from tests.pipeline.gap.recordings import Plant, joint_recording, joint_simulator

pytestmark = pytest.mark.slow

CHARGE = (1.0, 0.85, 0.95, 0.8, 0.9, 0.87)  # of the supply, run by run
REFERENCE = 12.0  # V at which a joint's battery is taken to do nothing


@functools.cache
def sagging(slope=0.0, charge=CHARGE, seed=0):
    """Return a recording of commands, of which the motor got what a battery of falling voltage made of them."""
    random = np.random.default_rng(seed)
    voltage = recordings.voltages(len(charge), 1600, random)
    supply = np.array(charge)[:, None] - slope * np.arange(1600) * recordings.TIME_STEP
    position, velocity = recordings.motion(Plant(), voltage * supply)
    noise = random.standard_normal((2, *voltage.shape))
    return recordings.recording_of(voltage, position + 2e-4 * noise[0], velocity + 0.02 * noise[1]), supply


def law_of(problem, simulator):
    effects = [e for e in undriven(simulator, problem.blocks, None) if e.driver == "battery_voltage"]
    return DriverLaw.of([FittedEffect(e, e.defaults()) for e in effects], problem, simulator)


@pytest.mark.parametrize("slope", [0.0, 0.01])
def test_levels_and_slopes_of_the_runs_are_recovered(slope):
    recording, supply = sagging(slope)
    simulator = joint_simulator()
    problem = problem_of(recording, simulator)
    found = problem.blocks.inner(law_of(problem, simulator).along(problem)).mean(1) / REFERENCE
    middle = problem.blocks.start + 0.5 * problem.blocks.samples * problem.blocks.time_step
    true = torch.from_numpy(supply)[problem.blocks.run, (middle / recordings.TIME_STEP).long()]
    assert float((found - true).abs().median()) < 0.01


def test_a_lag_follows_a_step_exactly_from_block_to_block():
    blocks = problem_of(sagging()[0], joint_simulator()).blocks
    found = lagged(blocks, torch.ones_like(constant(blocks, 1.0)), 2.0)
    sample = torch.arange(found.shape[1]) - blocks.margin
    elapsed = blocks.start[:, None] + (sample + 1) * blocks.time_step
    torch.testing.assert_close(found, 1.0 - torch.exp(-elapsed.clamp_min(0.0) / 2.0))


def test_the_fall_of_a_battery_under_load_is_recovered_with_its_late_part():
    """A source of Thévenin: 2 % of the supply at once and 3 % after a while, at 10 N·m·V."""
    simulator, per_load = joint_simulator(), (0.002, 0.003)
    voltage = recordings.voltages(len(CHARGE), 1600, np.random.default_rng(3))
    supply = np.ones_like(voltage)
    for _ in range(4):
        position, velocity = recordings.motion(Plant(), voltage * supply)
        load = voltage * recordings.GAIN * (voltage - recordings.GAIN * velocity)
        late = np.stack([lag_of(each, 3.0) for each in load])
        supply = np.array(CHARGE)[:, None] - per_load[0] * load - per_load[1] * late
    recording = recordings.recording_of(voltage, position, velocity)
    law = law_of(problem_of(recording, simulator), simulator)
    assert law.lag == 3.0
    assert law.at_once == pytest.approx(per_load[0] * REFERENCE, rel=0.15)
    assert law.late == pytest.approx(per_load[1] * REFERENCE, rel=0.15)


def lag_of(load, lag):
    """Return a load (samples,) through a first-order lag."""
    out = np.zeros_like(load)
    for place in range(1, len(load)):
        out[place] = out[place - 1] + (load[place] - out[place - 1]) * recordings.TIME_STEP / lag
    return out


def test_a_stretch_never_explains_itself():
    simulator = joint_simulator()
    problem = problem_of(sagging()[0], simulator)
    law = replace(law_of(problem, simulator), at_once=0.0, late=0.0)
    mine = problem.cluster == problem.cluster[0]
    velocity = problem.blocks.signals["velocity"].clone()
    velocity[mine] *= 1.001  # so little that a level is still borne out
    altered = replace(problem, blocks=with_signal(problem.blocks, "velocity", velocity))
    before, after = law.along(problem), law.along(altered)
    assert torch.allclose(after[mine], before[mine], rtol=1e-6)
    same_run = (problem.blocks.run == problem.blocks.run[0]) & ~mine
    assert not torch.allclose(after[same_run], before[same_run], rtol=1e-5)


def test_a_battery_that_nobody_recorded_is_named_and_said_to_be_estimated():
    found = quick(sagging()[0], joint_simulator())
    assert named(found) == ["battery_sag"]
    assert found.validation.gap_closed > 0.9
    assert any(warning.startswith("battery_voltage was not recorded") for warning in found.warnings)


def test_a_motor_that_is_warmer_in_some_runs_is_named_though_nobody_recorded_how_warm():
    """Warmth takes x of the torque at standstill; the magnets' part of it, 0.35, takes back-EMF, too."""
    lost = np.array([0.0, 0.12, 0.2, 0.05, 0.16, 0.24])
    random = np.random.default_rng(1)
    voltage = recordings.voltages(len(lost), 1600, random)
    weaker = (1.0 - lost) * (1.0 - 0.35 * lost)
    plant = Plant(viscous=tuple((weaker - 1.0) * recordings.GAIN**2))
    position, velocity = recordings.motion(plant, voltage * (1.0 - lost)[:, None])
    noise = random.standard_normal((2, *voltage.shape))
    recording = recordings.recording_of(voltage, position + 2e-4 * noise[0], velocity + 0.02 * noise[1])
    found = quick(recording, joint_simulator())
    assert named(found) == ["temperature_derating"]
    (motor,) = (f for f in found.simulator.effects if f.effect.name == "temperature_derating")
    assert motor.values["magnets_share"] == pytest.approx(0.35, abs=0.05)


def test_one_wrong_number_in_all_runs_is_no_battery():
    found = quick(joint_recording(Plant(motor_constant=1.1)), joint_simulator())
    assert named(found) == ["motor_constant_error"]


def test_what_was_recorded_is_not_estimated():
    simulator = joint_simulator()
    blocks = problem_of(joint_recording(Plant()), simulator).blocks
    assert {effect.driver for effect in undriven(simulator, blocks, None)} == {
        "battery_voltage",
        "temperature",
    }
    recorded = with_signal(blocks, "battery_voltage", torch.ones_like(blocks.signals["velocity"]))
    assert {effect.driver for effect in undriven(simulator, recorded, None)} == {"temperature"}
    assert undriven(simulator, blocks, ["coulomb_friction"]) == []
