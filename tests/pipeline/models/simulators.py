"""Learned models as parts of simulators, run on a layout's own windows."""

import torch
from torch import Tensor

from simgap.models.contract import DynamicsModel
from simgap.models.machine_state import input_signals
from simgap.models.simulated import LearnedMotion
from simgap.physics import rotations
from simgap.simulation import Simulator, step
from tests.pipeline.platforms.machines import MACHINES


def signals_of(model: DynamicsModel, states: Tensor, actions: Tensor) -> dict[str, Tensor]:
    """Return the signals that a layout's states and inputs stand for."""
    kind, names = model.layout.kind, input_signals(model.layout)
    if kind == "joint":
        signals = {"position": states[..., 0], "velocity": states[..., 1], names[0]: actions[..., 0]}
        return signals
    pushed = dict(zip(names, actions.split(4, dim=-1), strict=True))
    if kind == "quadrotor":
        position, attitude, velocity, rate = states.split((3, 4, 3, 3), dim=-1)
        velocity = rotations.rotate_inverse(attitude, velocity)
        return pushed | {
            "position": position,
            "attitude": attitude,
            "velocity": velocity,
            "body_rate": rate,
        }
    twist = states[..., :3] if kind == "swerve_chassis" else torch.zeros_like(states[..., :3])
    drive, steer, angle = states[..., -12:].split(4, dim=-1)
    modules = {"drive_velocity": drive, "steer_velocity": steer, "steer_angle": angle}
    return pushed | modules | {"chassis_velocity": twist}


def simulated(model: DynamicsModel, states: Tensor, actions: Tensor) -> Tensor:
    """Return what `model.rollout` does, by a simulator that the model moves."""
    kind = model.layout.kind.partition("_")[0]
    learned = LearnedMotion(model, MACHINES[kind])
    simulator = Simulator(MACHINES[kind], learned=learned)
    length, machine = states.shape[1], learned.machine
    known = signals_of(model, states, actions[:, :length])
    state = learned._motion.pack({name: series[:, -1] for name, series in known.items()})
    memory, reached = (learned.begin(known),), []
    for action in actions[:, length - 1 :].unbind(1):
        pushed = signals_of(model, states[:, -1], action)
        command = {name: pushed[name] for name in learned.inputs}
        state, memory = step(simulator, state, command, model.time_step, memory)
        reached.append(machine.seen(state, memory[-1].kept))
    return torch.stack(reached, dim=1)
