"""A swerve drive whose simulator lacks one thing is told which, on drives recorded from a simulator that has it."""

import functools

import numpy as np
import pandas as pd
import pytest

from simgap.diagnosis.diagnose import Diagnosis
from simgap.effects import effect_by_key
from simgap.platforms import DirectCurrentMotor, Swerve, SwerveAxis
from simgap.platforms.swerve import SteerAxis
from simgap.recordings.recording import Recording
from simgap.simulation import FittedEffect, Simulator
from simgap.simulation.motion import motion_of
from tests.pipeline.gap.problems import named, quick
from tests.pipeline.simulation.drives import driven

pytestmark = pytest.mark.slow

_STEP = 0.01  # s
_SAMPLES = 600
_RUNS = 4
_CHASSIS = ("chassis_velocity_x", "chassis_velocity_y", "chassis_rate")


def swerve() -> Swerve:
    motor = DirectCurrentMotor(nominal_voltage=12.0, free_speed=594.0, stall_torque=2.6, stall_current=105.0)
    corners = ((0.3, 0.3), (0.3, -0.3), (-0.3, 0.3), (-0.3, -0.3))
    return Swerve(54.0, 5.0, corners, 0.0508, SwerveAxis(6.75, motor), SteerAxis(12.8, motor, 0.05))


def drives(
    simulator: Simulator, random: np.random.Generator, supply: tuple[float, ...] = (1.0,) * _RUNS
) -> pd.DataFrame:
    """Drive to and fro while the modules stand as the motion demands; the commands are held between samples.

    The drive motors get a share of their commands, run by run; the steering motors get theirs.
    """
    states, commands = driven(simulator, _RUNS, _SAMPLES, _STEP, seed=7)
    signals = motion_of(simulator.platform).signals(states, simulator.constants())
    noise = {"drive_velocity": 0.3, "steer_velocity": 0.01, "steer_angle": 0.001}
    frames = []
    for run in range(_RUNS):
        columns: dict[str, object] = {"run": f"drive_{run}", "t": np.arange(_SAMPLES) * _STEP}
        for wheel in range(4):
            for name, share in (("drive_voltage", supply[run]), ("steer_voltage", 1.0)):
                columns[f"{name}_{wheel + 1}"] = commands[name][run, :, wheel].numpy() / share
            for name, size in noise.items():
                measured = signals[name][run, :, wheel].numpy() + random.normal(0, size, _SAMPLES)
                columns[f"{name}_{wheel + 1}"] = measured
        for axis, name in enumerate(_CHASSIS):
            exact = signals["chassis_velocity"][run, :, axis].numpy()
            columns[name] = exact + random.normal(0, 0.003, _SAMPLES)
        frames.append(pd.DataFrame(columns))
    return pd.concat(frames, ignore_index=True)


@functools.cache
def diagnosed(key: str | None, name: str = "", value: float = 0.0) -> Diagnosis:
    effects = () if key is None else (FittedEffect(effect_by_key("swerve", key), {name: value}),)
    simulator = Simulator(
        swerve(), effects, settings={"drive_sliding_velocity": 0.05, "steer_sliding_velocity": 0.05}
    )
    return quick(recorded(drives(simulator, np.random.default_rng(7))), Simulator(swerve()))


def recorded(frame: pd.DataFrame) -> Recording:
    """Return drives as a cleaned recording, of which the first one is held out."""
    split = {f"drive_{run}": "holdout" if run == 0 else "train" for run in range(_RUNS)}
    units = dict.fromkeys(frame.columns[2:], "1")
    return Recording(frame, "swerve", units, split=split, cleaned=True)


@pytest.mark.parametrize(
    ("key", "name", "value"),
    [
        ("coulomb_friction@drive", "level", 1.5),
        ("viscous_friction@drive", "coefficient", 0.05),
        ("current_limit@drive", "limit", 20.0),
        ("command_delay@drive", "delay", 0.05),
    ],
)
def test_what_the_drive_lacks_is_named_alone_with_its_value(key, name, value):
    found = diagnosed(key, name, value)
    assert found.verdict == "missing_physics"
    assert [candidate.effect.key for candidate in found.naming.named] == [key]
    fitted = {effect.effect.key: effect for effect in found.simulator.effects}[key]
    assert fitted.values[name] == pytest.approx(value, rel=0.05)
    assert found.validation.gap_closed is not None
    assert found.validation.gap_closed > 0.9


def test_a_drive_that_lacks_nothing_gets_no_name():
    found = diagnosed(None)
    assert not found.naming.named
    assert found.verdict == "none"


def test_a_battery_that_the_drive_motors_alone_follow_is_named_though_nobody_recorded_it():
    frame = drives(Simulator(swerve()), np.random.default_rng(7), supply=(1.0, 0.9, 0.97, 0.84))
    rivals = ["battery_sag", "motor_constant_error", "mass_error", "current_limit", "viscous_friction"]
    assert named(quick(recorded(frame), Simulator(swerve()), rivals)) == ["battery_sag@drive"]
