"""Recordings with a known answer: a joint simulated apart from the catalogue, and flights of the concealed plant."""

import functools
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import pandas as pd
import torch
import yaml

from simgap.effects import effect_by_key
from simgap.plants.case import PlantCase
from simgap.plants.fly import fly
from simgap.platforms import Joint, Quadrotor, platform_from_config
from simgap.platforms.joint import JointMotor
from simgap.recordings.excerpt import of_runs
from simgap.recordings.recording import Recording
from simgap.simulation import FittedEffect, Simulator
from simgap.simulation.rollout import step

ROOT = Path(__file__).parents[3]
JOINT = Joint(inertia=0.05, motor=JointMotor(resistance=1.0, torque_constant=0.05, gear_ratio=10.0))
GAIN = 0.5  # N·m/A and V/(rad/s) at the joint
TIME_STEP = 5e-3  # s
SUBSTEPS = 5
_QUADROTOR_STATE = [
    *(f"position_{axis}" for axis in "xyz"),
    *(f"attitude_{part}" for part in "wxyz"),
    *(f"velocity_{axis}" for axis in "xyz"),
    *(f"body_rate_{axis}" for axis in "xyz"),
]


@dataclass(frozen=True)
class Plant:
    """What is truly there.

    Attributes:
        friction: Coulomb, N·m; one number, or one per run.
        viscous: N·m·s/rad; one number, or one per run.
        current_limit: A.
        delay: of the voltage, s; a whole number of substeps.
        inertia: true over nominal.
        motor_constant: true over nominal.
        other: torque from position and velocity that no effect of the catalogue describes.
    """

    friction: float | tuple[float, ...] = 0.0
    viscous: float | tuple[float, ...] = 0.0
    current_limit: float = np.inf
    delay: float = 0.0
    inertia: float = 1.0
    motor_constant: float = 1.0
    other: Callable[[np.ndarray, np.ndarray], np.ndarray] | None = field(default=None)


def voltages(runs: int, samples: int, random: np.random.Generator) -> np.ndarray:
    """Ramps, steps and multisines in turn, V: (runs, samples)."""
    time = np.arange(samples) * TIME_STEP
    signals = []
    for run in range(runs):
        phase, peak = random.uniform(0.0, 2.0 * np.pi, 6), random.uniform(5.0, 10.0)
        if run % 3 == 0:
            signals.append(peak * 2.0 / np.pi * np.arcsin(np.sin(2.0 * np.pi * time / 4.0 + phase[0])))
        elif run % 3 == 1:
            levels = np.repeat(random.uniform(-peak, peak, samples // 80 + 1), 80)
            signals.append(levels[:samples])
        else:
            frequencies = np.array([0.3, 0.7, 1.1, 1.9, 3.1, 4.7])
            waves = np.sin(2.0 * np.pi * frequencies[:, None] * time + phase[:, None])
            signals.append(peak / 3.0 * waves.sum(0))
    return np.stack(signals)


def motion(plant: Plant, voltage: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Position and velocity at the samples under held voltages: (runs, samples) each.

    Heun's rule; friction is an impulse that stops the axis or slows it by its level and never turns it round, which
    makes stick and slip exact.
    """
    runs, samples = voltage.shape
    step, late = TIME_STEP / SUBSTEPS, round(plant.delay / TIME_STEP * SUBSTEPS)
    fine = np.repeat(voltage, SUBSTEPS, axis=1)
    fine = np.concatenate([np.repeat(voltage[:, :1], late, axis=1), fine], axis=1)
    inertia, gain = JOINT.inertia * plant.inertia, GAIN * plant.motor_constant
    dry = np.broadcast_to(plant.friction, runs) * step / inertia
    viscous, most = np.broadcast_to(plant.viscous, runs), plant.current_limit
    position, velocity = np.zeros(runs), np.zeros(runs)
    kept = np.empty((2, runs, samples))

    def acceleration(position: np.ndarray, velocity: np.ndarray, applied: np.ndarray) -> np.ndarray:
        current = np.clip(applied - gain * velocity, -most, most)  # resistance is 1 Ω
        torque = gain * current - viscous * velocity
        return (torque if plant.other is None else torque + plant.other(position, velocity)) / inertia

    for index in range(samples * SUBSTEPS):
        if index % SUBSTEPS == 0:
            kept[:, :, index // SUBSTEPS] = position, velocity
        first = acceleration(position, velocity, fine[:, index])
        second = acceleration(position + step * velocity, velocity + step * first, fine[:, index])
        moved = velocity + 0.5 * step * (first + second)
        after = np.sign(moved) * np.maximum(np.abs(moved) - dry, 0.0)
        position = position + 0.5 * step * (velocity + after)
        velocity = after
    return kept[0], kept[1]


def joint_recordings(
    plant: Plant, seeds: list[int], runs: int = 6, duration: float = 8.0, noise: float = 1.0
) -> list[Recording]:
    """One recording per seed, simulated all at once; the last two runs of each are held out."""
    samples = round(duration / TIME_STEP)
    randoms = [np.random.default_rng(seed) for seed in seeds]
    voltage = np.concatenate([voltages(runs, samples, random) for random in randoms])
    repeated = {
        name: tuple(np.tile(value, len(seeds)))
        for name in ("friction", "viscous")
        if isinstance(value := getattr(plant, name), tuple)
    }
    position, velocity = motion(replace(plant, **repeated), voltage)
    recordings = []
    for index, random in enumerate(randoms):
        mine = slice(index * runs, (index + 1) * runs)
        shape = (runs, samples)
        read_position = position[mine] + noise * 2e-4 * random.standard_normal(shape)
        read_velocity = velocity[mine] + noise * 0.02 * random.standard_normal(shape)
        recordings.append(recording_of(voltage[mine], read_position, read_velocity))
    return recordings


def recording_of(voltage: np.ndarray, position: np.ndarray, velocity: np.ndarray) -> Recording:
    runs, samples = voltage.shape
    names = [f"run_{run}" for run in range(runs)]
    frame = pd.DataFrame(
        {
            "run": np.repeat(names, samples),
            "t": np.tile(np.arange(samples) * TIME_STEP, runs),
            "position": position.ravel(),
            "velocity": velocity.ravel(),
            "voltage": voltage.ravel(),
        }
    )
    units = {"position": "rad", "velocity": "rad/s", "voltage": "V"}
    split = {name: "holdout" if run >= runs - 2 and runs > 2 else "train" for run, name in enumerate(names)}
    return Recording(frame, "joint", units, source="the test's own joint", split=split, cleaned=True)


def pulled_slowly(plant: Plant) -> Recording:
    """Return a recording, driven by torques, of a motion far below what the plant would swing at."""
    time, phases = np.arange(2400) * TIME_STEP, np.arange(6)[:, None]
    waves = [
        size * np.sin(2.0 * np.pi * hertz * time + turns * phases)
        for size, hertz, turns in ((4.0, 0.3, 1), (2.0, 0.7, -2))
    ]
    position, velocity = motion(plant, sum(waves))
    noise = np.random.default_rng(0).standard_normal((2, *position.shape))
    recorded = recording_of(sum(waves), position + 1e-4 * noise[0], velocity + 2e-3 * noise[1])
    frame = recorded.frame.assign(effort=GAIN * recorded.frame["voltage"]).drop(columns="voltage")
    return replace(recorded, frame=frame, units={"position": "rad", "velocity": "rad/s", "effort": "N·m"})


@functools.cache
def joint_recording(plant: Plant, seed: int = 0, runs: int = 6, noise: float = 1.0) -> Recording:
    """Return one recording of a plant, kept for the session."""
    return joint_recordings(plant, [seed], runs=runs, noise=noise)[0]


def joint_simulator(*effects: FittedEffect) -> Simulator:
    """Return what is believed of the joint."""
    return Simulator(JOINT, effects)


@functools.cache
def racer() -> Quadrotor:
    """Return the platform of the concealed quadrotor."""
    return platform_from_config(yaml.safe_load((ROOT / "conf/platform/racer.yaml").read_text()))


@functools.cache
def flown(effects: tuple[tuple[str, float], ...], seed: int, runs: int) -> Recording:
    """Return short flights of the concealed plant, kept for the session."""
    case = PlantCase(effects=dict(effects), runs=runs, duration=4.0)
    return replace(fly(case, racer(), seed)[0], cleaned=True)


def flight(*effects: tuple[str, float]) -> Recording:
    """Return eight short flights of a plant with these effects; the last two are held out."""
    return with_holdout(flown(effects, seed=0, runs=8))


def uneventful_flights() -> list[Recording]:
    """Return four recordings of a plant without any concealed effect, eight flights each."""
    every = flown((), seed=1, runs=32)
    return [with_holdout(of_runs(every, every.runs[part::4])) for part in range(4)]


def late(recording: Recording, samples: int) -> Recording:
    """Return the recording with its state a whole number of samples behind its motors."""
    frame = recording.frame.copy()
    motors = [column for column in frame if str(column).startswith("motor_")]
    frame[motors] = frame.groupby("run", sort=False)[motors].shift(-samples)
    return replace(recording, frame=frame.dropna(subset=motors).reset_index(drop=True))


@functools.cache
def held_flights(time_constant: float) -> Recording:
    """Return flights of a controller that is as slow as its log, whose commands rotors follow with a lag, s."""
    runs, steps, time_step = 6, 400, 0.01
    random, platform = np.random.default_rng(0), racer()
    lag = FittedEffect(effect_by_key("quadrotor", "motor_lag"), {"time_constant": time_constant})
    simulator = Simulator(platform, (lag,))
    position, turn = np.array(platform.rotor_positions), np.array(platform.rotor_directions)
    torque_per_thrust = platform.torque_coefficient / platform.thrust_coefficient
    allocation = np.linalg.inv(
        np.stack([np.ones(4), position[:, 1], -position[:, 0], torque_per_thrust * turn])
    )
    waves = random.uniform(2.0, 14.0, (runs, 4, 3)), random.uniform(0.0, 2.0 * np.pi, (runs, 4, 3))
    state = torch.zeros(runs, 13, dtype=torch.float64)
    state[:, 3] = 1.0
    memory, kept = (), []
    for index in range(steps):
        dither = np.sin(waves[0] * index * time_step + waves[1]).sum(-1)
        now = state.numpy()
        wanted = -100.0 * 2.0 * now[:, 4:7] - 20.0 * now[:, 10:13] + 12.0 * dither[:, 1:]
        torque = np.array(platform.inertia) * wanted
        thrust = platform.mass * (platform.gravity + 1.5 * dither[:, :1])
        each = (np.concatenate([thrust, torque], axis=1) @ allocation.T).clip(0.05, 8.0)
        command = np.sqrt(each / platform.thrust_coefficient) / platform.motor_speed_max
        kept.append(np.concatenate([now, command], axis=1))
        commands = {"motor_command": torch.from_numpy(command)}
        state, memory = step(simulator, state, commands, time_step, memory, 4)
    rows = np.stack(kept, axis=1).reshape(runs * steps, 17)
    names = [f"flight_{run}" for run in range(runs)]
    frame = pd.DataFrame(rows, columns=[*_QUADROTOR_STATE, *(f"motor_command_{i}" for i in range(1, 5))])
    noise = {"position": 1e-3, "attitude": 1e-3, "velocity": 0.02, "body_rate": 0.01}
    for column in _QUADROTOR_STATE:
        frame[column] += noise[column.rsplit("_", 1)[0]] * random.standard_normal(len(frame))
    frame.insert(0, "t", np.tile(np.arange(steps) * time_step, runs))
    frame.insert(0, "run", np.repeat(names, steps))
    return with_holdout(Recording(frame, "quadrotor", {}, source="the test's own flights", cleaned=True))


def with_holdout(recording: Recording) -> Recording:
    """Return a recording whose last two runs are held out."""
    runs = recording.runs
    split = {run: "holdout" if index >= len(runs) - 2 else "train" for index, run in enumerate(runs)}
    return replace(recording, split=split)
