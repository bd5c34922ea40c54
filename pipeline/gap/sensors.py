"""Whether the sensors of a recording agree with each other, before any physics is asked."""

from dataclasses import replace

import torch
from torch import Tensor

from pipeline.gap.blocks import Blocks
from pipeline.gap.weak_form import WindowFunctions, mean_of, mean_rate_of, window_functions
from pipeline.physics import rotations

_NOTABLE = 0.05  # m/s²: half a hundredth of gravity, the zero error of a calibrated consumer accelerometer


def settle_accelerometer(blocks: Blocks, gravity: float, width: float) -> tuple[Blocks, list[str]]:
    """Remove each run's accelerometer zero error, which motion capture or odometry shows without any model.

    Velocity and attitude give the specific force by kinematics alone, (du/dt) + ω × u − Rᵀg; what the accelerometer
    reads more than that on average over a run is its zero error.

    Returns:
        The blocks with the error taken out, and a sentence for every run where it is worth knowing.
    """
    if "specific_force" not in blocks.signals:
        return blocks, []
    functions = window_functions(blocks.samples, width, blocks.time_step)
    difference = _accelerometer_minus_kinematics(blocks, gravity, functions)  # (blocks, rows, 3)
    corrected, remarks = blocks.signals["specific_force"].clone(), []
    for index, name in enumerate(blocks.runs):
        mine = blocks.run == index
        if not mine.any():
            continue
        zero = difference[mine].flatten(0, 1).median(0).values
        corrected[mine] -= zero
        if zero.abs().max() > _NOTABLE:
            text = ", ".join(f"{value:+.2f}" for value in zero.tolist())
            remarks.append(f"the accelerometer of run {name} reads ({text}) m/s² too much along x, y, z; taken out")
    return replace(blocks, signals={**blocks.signals, "specific_force": corrected}), remarks


def _accelerometer_minus_kinematics(blocks: Blocks, gravity: float, functions: WindowFunctions) -> Tensor:
    signals = {name: blocks.inner(series) for name, series in blocks.signals.items()}
    velocity, rate = signals["velocity"], signals["body_rate"]
    down = torch.zeros_like(velocity)
    down[..., 2] = -gravity
    turning = torch.linalg.cross(rate, velocity) - rotations.rotate_inverse(signals["attitude"], down)
    read = signals["specific_force"] - turning
    rows = [
        mean_of(functions, read[..., axis]) - mean_rate_of(functions, velocity[..., axis])
        for axis in range(3)
    ]
    return torch.stack(rows, dim=-1)
