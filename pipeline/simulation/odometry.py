"""The motion of a swerve drive that nobody measured: states as the wheels of its platform file tell them.

Such a recording holds what the wheels show. A simulator whose wheels point elsewhere, or are smaller, moves otherwise
while its wheels show the same.
"""

from jaxtyping import Float
from torch import Tensor

from simgap.physics.shapes import Signals
from simgap.platforms.swerve_mechanism import ROLLED, twist_from_wheels
from simgap.simulation.motion import motion_of
from simgap.simulation.simulator import Simulator


def moving(
    simulator: Simulator, state: Float[Tensor, "blocks components"], signals: Signals
) -> Float[Tensor, "blocks components"]:
    """Return recorded states with the motion that a simulator's wheels make of them.

    Args:
        simulator: that starts there.
        state: recorded, (blocks, n).
        signals: recorded at the same samples; where they hold no motion taken from the wheels, states stay as they are.
    """
    if ROLLED not in signals:
        return state
    motion = motion_of(simulator.platform, signals)
    twist = twist_from_wheels(signals, simulator.constants())
    return motion.pack(motion.signals(state, simulator.constants()) | {"chassis_velocity": twist})


def shown(
    simulator: Simulator, states: Float[Tensor, "blocks samples components"], signals: Signals
) -> Float[Tensor, "blocks samples components"]:
    """Return simulated states with the motion that the wheels of the platform file would show.

    Args:
        simulator: that they come from.
        states: (blocks, samples, n).
        signals: recorded; where they hold no motion taken from the wheels, states stay as they are.
    """
    if ROLLED not in signals:
        return states
    motion = motion_of(simulator.platform, signals)
    simulated = motion.signals(states, simulator.constants())
    twist = twist_from_wheels(simulated, simulator.mechanism.constants())
    return motion.pack(simulated | {"chassis_velocity": twist})
