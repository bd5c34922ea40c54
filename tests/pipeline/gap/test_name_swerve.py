"""A swerve drive whose simulator lacks one thing is told which, on drives recorded from a simulator that has it."""

import functools

import numpy as np
import pandas as pd
import pytest
import torch

from pipeline.effects import effect_by_key
from pipeline.gap.diagnosis import Diagnosis, diagnose
from pipeline.gap.settings import Gap
from pipeline.platforms import DirectCurrentMotor, Swerve, SwerveAxis
from pipeline.platforms.swerve import SteerAxis
from pipeline.recordings.recording import Recording
from pipeline.simulation import FittedEffect, Simulator, rollout
from pipeline.simulation.motion import motion_of

_STEP = 0.01  # s
_SAMPLES = 1000
_RUNS = 4
_CHASSIS = ("chassis_velocity_x", "chassis_velocity_y", "chassis_rate")


def swerve() -> Swerve:
    motor = DirectCurrentMotor(nominal_voltage=12.0, free_speed=594.0, stall_torque=2.6, stall_current=105.0)
    corners = ((0.3, 0.3), (0.3, -0.3), (-0.3, 0.3), (-0.3, -0.3))
    return Swerve(54.0, 5.0, corners, 0.0508, SwerveAxis(6.75, motor), SteerAxis(12.8, motor, 0.05))


def multisine(random: np.random.Generator, amplitudes: tuple[float, float], fastest: float) -> np.ndarray:
    time = np.arange(_SAMPLES) * _STEP
    parts = zip(
        random.uniform(*amplitudes, 4),
        random.uniform(0.05, fastest, 4),
        random.uniform(0, 2 * np.pi, 4),
        strict=True,
    )
    return sum(size * np.sin(2 * np.pi * rate * time + phase) for size, rate, phase in parts)


def drive(simulator: Simulator, random: np.random.Generator, run: str) -> pd.DataFrame:
    """Drive with the same voltage on all wheels while the modules wave; the commands are held between samples."""
    together = multisine(random, (1.0, 4.0), 0.8)
    drive_voltage = np.stack([together + random.normal(0, 0.3) for _ in range(4)], axis=1)
    steer_voltage = np.stack([multisine(random, (0.1, 0.5), 1.5) for _ in range(4)], axis=1)
    commands = {"drive_voltage": drive_voltage, "steer_voltage": steer_voltage}
    batch = {name: torch.tensor(value)[None] for name, value in commands.items()}
    states = rollout(simulator, torch.zeros(1, 11, dtype=torch.float64), batch, _STEP, substeps=4)[0, :-1]
    signals = motion_of(simulator.platform).signals(states)
    noise = {"drive_velocity": 0.3, "steer_velocity": 0.01, "steer_angle": 0.001}
    columns: dict[str, object] = {"run": run, "t": np.arange(_SAMPLES) * _STEP}
    for wheel in range(4):
        columns |= {f"{name}_{wheel + 1}": value[:, wheel] for name, value in commands.items()}
        for name, size in noise.items():
            measured = signals[name][:, wheel].numpy() + random.normal(0, size, _SAMPLES)
            columns[f"{name}_{wheel + 1}"] = measured
    for axis, name in enumerate(_CHASSIS):
        columns[name] = signals["chassis_velocity"][:, axis].numpy() + random.normal(0, 0.003, _SAMPLES)
    return pd.DataFrame(columns)


@functools.cache
def diagnosed(key: str | None, name: str = "", value: float = 0.0) -> Diagnosis:
    effects = () if key is None else (FittedEffect(effect_by_key("swerve", key), {name: value}),)
    simulator = Simulator(swerve(), effects, settings={"sliding_velocity": 0.05})
    random = np.random.default_rng(7)
    frame = pd.concat([drive(simulator, random, f"drive_{run}") for run in range(_RUNS)], ignore_index=True)
    split = {f"drive_{run}": "holdout" if run == 0 else "train" for run in range(_RUNS)}
    units = dict.fromkeys(frame.columns[2:], "1")
    recording = Recording(frame, "swerve", units, split=split, cleaned=True)
    return diagnose(recording, Simulator(swerve()), Gap())


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
    assert found.proof.gap_closed is not None
    assert found.proof.gap_closed > 0.9


def test_a_drive_that_lacks_nothing_gets_no_name():
    found = diagnosed(None)
    assert not found.naming.named
    assert found.verdict == "none"
