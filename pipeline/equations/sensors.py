"""Agreement of the sensors of a recording: accelerometer zero and velocity delay, corrected before any fit."""

from dataclasses import replace

import torch
from torch import Tensor

from simgap.effects.shift import shift_in_time
from simgap.physics import rotations
from simgap.physics.weak_form import WindowFunctions, mean_of, mean_rate_of, window_functions
from simgap.simulation.blocks import Blocks

_AGREED = 0.5  # of the disagreement, which a shift must remove
_NOTABLE_ZERO_ERROR = 0.05  # m/s²; the zero error of a calibrated consumer accelerometer


def settle_accelerometer(blocks: Blocks, gravity: float, width: float) -> tuple[Blocks, list[str]]:
    """Remove each run's accelerometer zero error, which motion capture or odometry shows without any model.

    Velocity and attitude give the specific force by kinematics alone, (du/dt) + ω × u − Rᵀg; what the accelerometer
    reads more than that on average over a run is its zero error.

    Returns:
        The blocks with the error taken out, and a sentence about it where it is worth knowing.
    """
    if not {"specific_force", "velocity"} <= blocks.signals.keys():
        return blocks, []
    functions = window_functions(blocks.samples, width, blocks.time_step)
    difference = _accelerometer_minus_kinematics(blocks, gravity, functions)  # (blocks, rows, 3)
    corrected = blocks.signals["specific_force"].clone()
    zeros: dict[str, Tensor] = {}
    for index in torch.unique(blocks.run).tolist():
        mine = blocks.run == index
        zeros[blocks.runs[index]] = zero = difference[mine].flatten(0, 1).median(0).values
        corrected[mine] -= zero
    return replace(blocks, signals={**blocks.signals, "specific_force": corrected}), _remarks(zeros)


def settle_velocity(blocks: Blocks, width: float) -> tuple[Blocks, list[str]]:
    """Shift a joint's velocity to the clock of its position: a filtered velocity is late.

    One shift is found for all runs. It is made in those that it brings nearer to their position: where cleaning has put
    the rate of the position in the place of a velocity, that is not late.

    Returns:
        The blocks with the velocity shifted where it was late or early, and a sentence about it.
    """
    functions = window_functions(blocks.samples, width, blocks.time_step)
    rate = mean_rate_of(functions, blocks.inner(blocks.signals["position"]))

    def moved(late: int) -> Tensor:
        return shift_in_time(blocks.signals["velocity"], -late * blocks.time_step, blocks.time_step)

    def disagreement(late: int) -> Tensor:
        """Return the mean square of the disagreement in each run, (runs,); 0 in one without blocks."""
        energy = (rate - mean_of(functions, blocks.inner(moved(late)))).square().mean(1)
        return energy.new_zeros(len(blocks.runs)).index_add(0, blocks.run, energy) / len(blocks)

    errors = {late: disagreement(late) for late in range(-blocks.margin, blocks.margin + 1)}
    left = {samples: float(torch.minimum(each, errors[0]).sum()) for samples, each in errors.items()}
    late = min(left, key=lambda samples: left[samples])
    if abs(late) <= 1 or left[late] > _AGREED * left[0]:
        return blocks, []
    nearer = errors[late] < errors[0]
    shifted = torch.where(nearer[blocks.run, None], moved(late), blocks.signals["velocity"])
    present = torch.unique(blocks.run)
    where = "" if bool(nearer[present].all()) else f" in {int(nearer.sum())} of {len(present)} runs"
    remark = (
        f"the velocity was recorded {abs(late * blocks.time_step):.3g} s {'late' if late > 0 else 'early'} relative to "
        f"the position{where}; the shift was removed"
    )
    return replace(blocks, signals={**blocks.signals, "velocity": shifted}), [remark]


def _remarks(zeros: dict[str, Tensor]) -> list[str]:
    notable = {run: zero for run, zero in zeros.items() if zero.abs().max() > _NOTABLE_ZERO_ERROR}
    if not notable:
        return []
    worst = max(notable, key=lambda run: float(notable[run].abs().max()))
    text = ", ".join(f"{value:+.2f}" for value in notable[worst].tolist())
    return [
        f"the accelerometer has a zero error in {len(notable)} of {len(zeros)} runs, the largest in run {worst}: "
        f"({text}) m/s² along x, y, z, compared with velocity and attitude; it was removed"
    ]


def _accelerometer_minus_kinematics(blocks: Blocks, gravity: float, functions: WindowFunctions) -> Tensor:
    signals = {name: blocks.inner(series) for name, series in blocks.signals.items()}
    velocity, rate = signals["velocity"], signals["body_rate"]
    down = torch.zeros_like(velocity)
    down[..., 2] = -gravity
    turning = rotations.cross(rate, velocity) - rotations.rotate_inverse(signals["attitude"], down)
    read = signals["specific_force"] - turning
    rows = [
        mean_of(functions, read[..., axis]) - mean_rate_of(functions, velocity[..., axis])
        for axis in range(3)
    ]
    return torch.stack(rows, dim=-1)
