"""Machines of every kind with an effect that holds a hidden state, and states and commands that they may have."""

import numpy as np

from simgap.api.machine import Machine
from simgap.api.simulators import build_simulator
from tests.pipeline.platforms.machines import JOINT, MACHINES, QUADROTOR, SWERVE

DT = 0.01  # s
REMEMBERING = {
    "motor_lag": (QUADROTOR, {"time_constant": 0.05}),
    "slung_payload": (QUADROTOR, {}),
    "backlash": (JOINT, {"gap": 0.05}),
    "command_delay": (JOINT, {"delay": 0.03}),
    "motor_inductance@drive": (SWERVE, {}),
    "command_delay@steer": (SWERVE, {"delay": 0.025}),
}


def bare(kind: str, command: str | None = None) -> Machine:
    return build_simulator(MACHINES[kind], command=command)


def remembering(effect: str) -> Machine:
    platform, values = REMEMBERING[effect]
    return build_simulator(platform, {effect: values})


def states(machine: Machine, batch: tuple[int, ...], seed: int = 0) -> np.ndarray:
    """Return states near rest, (*batch, n)."""
    shift = 0.1 * np.random.default_rng(seed).standard_normal((*batch, len(machine.state_names)))
    return machine.state() + shift


def commands(machine: Machine, shape: tuple[int, ...], seed: int = 1) -> np.ndarray:
    """Return commands that change at every step, (*shape, m)."""
    random = np.random.default_rng(seed)
    scale = 1.0 if machine.kind == "quadrotor" else 6.0
    return scale * random.uniform(0.0, 1.0, (*shape, len(machine.command_names)))
