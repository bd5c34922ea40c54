"""Replaying a recording: the recorded commands drive the simulator open loop, from a recorded state."""

import torch
from torch import Tensor

from pipeline.effects import CommandEffect, MeasurementEffect
from pipeline.simulation.blocks import Blocks
from pipeline.simulation.motion import motion_of
from pipeline.simulation.rollout import rollout
from pipeline.simulation.simulator import Simulator

_COMMANDS = {
    "quadrotor": ("rotor_speed", "motor_command"),
    "joint": ("voltage", "effort"),
    "swerve": ("drive_voltage", "steer_voltage"),
}


def replay(simulator: Simulator, blocks: Blocks, initial: Tensor, steps: int) -> Tensor:
    """Roll every block out with its recorded commands.

    Clocks are settled and delays applied on the whole block first, since the margin knows what was commanded before.

    Args:
        simulator: platform and effects.
        blocks: of a recording.
        initial: states at the first sample of each block, (blocks, n).
        steps: at most one less than the samples of a block.

    Returns:
        States (blocks, steps + 1, n).
    """
    signals, constants = dict(blocks.signals), simulator.constants()
    for fitted in simulator.of_type(MeasurementEffect):
        signals = fitted.effect.undo(signals, fitted.values, blocks.time_step)  # type: ignore[attr-defined]
    for fitted in simulator.of_type(CommandEffect):
        signals = fitted.effect.along_time(  # type: ignore[attr-defined]
            signals, fitted.values, constants, blocks.time_step
        )
    commands = {}
    for name in _COMMANDS[simulator.platform.kind]:
        if name in signals:
            series = blocks.inner(signals[name])
            # Signals are centred on their samples; over a step the mean of its two ends acts.
            commands[name] = 0.5 * (series[:, :steps] + series[:, 1 : steps + 1])
    settled = (MeasurementEffect, CommandEffect)
    bare = simulator.with_effects(tuple(f for f in simulator.effects if not isinstance(f.effect, settled)))
    return rollout(bare, initial, commands, blocks.time_step)


def replay_error(simulator: Simulator, blocks: Blocks, duration: float) -> dict[str, float]:
    """Return the root mean square error of each part of the state after replaying for a duration, in SI units."""
    steps = max(min(round(duration / blocks.time_step), blocks.samples - 1), 1)
    motion = motion_of(simulator.platform)
    signals = {name: blocks.inner(series) for name, series in blocks.signals.items()}
    recorded = motion.pack(signals)
    last = replay(simulator, blocks, recorded[:, 0], steps)[:, -1]
    difference = last - recorded[:, steps]
    rms = {name: difference[:, where].square().sum(-1).mean().sqrt() for name, where in motion.parts.items()}
    return {
        f"replay_error_{name}": float(torch.nan_to_num(value, nan=torch.inf)) for name, value in rms.items()
    }
