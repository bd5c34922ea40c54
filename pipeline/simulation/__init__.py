"""Floor 4: simulators, each a platform with its nominal mechanism and named effects."""

from simgap.simulation.replay import replay, replay_error
from simgap.simulation.rollout import rollout, step
from simgap.simulation.simulator import Balance, FittedEffect, Simulator
from simgap.simulation.storage import read_simulator, write_simulator

__all__ = [
    "Balance",
    "FittedEffect",
    "Simulator",
    "read_simulator",
    "replay",
    "replay_error",
    "rollout",
    "step",
    "write_simulator",
]
