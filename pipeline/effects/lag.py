"""First-order lags of recorded series: between means over the same steps, and between samples.

Source: Krishnan 2001, Electric motor drives, §2; Franklin, Powell & Workman 1998, Digital control of dynamic systems,
§6.3 (equivalents by hold). Neither adds a delay of its own.
"""

import torch
from torch import Tensor

from simgap.effects.recurrence import accumulated
from simgap.physics.shapes import Real, Series, Signal, Value

_FORGOTTEN = 1 / 40  # of a step: so short a lag has decayed to e⁻⁴⁰ at the end of the step


def lag_step(start: Real, target: Real, time_constant: Value, time_step: float) -> tuple[Real, Real]:
    """Return the mean over a step and the value at its end of dy/dt = (target − y) / time_constant.

    Exact for a target that is held over the step.

    Args:
        start: y at the start of the step, any unit.
        target: held over the step.
        time_constant: s; at 0 the target is met at once. Smooth there.
        time_step: s.
    """
    decay, share = _decay(target, time_constant, time_step)
    behind = start - target
    return target + share * behind, target + decay * behind


def lag_along_time(target: Series, time_constant: float | Signal, time_step: float) -> Series:
    """Return the means of `lag_step` along recorded blocks, settled at their first sample.

    Args:
        target: (blocks, samples, ...).
        time_constant: s; one number, or a tensor that broadcasts with the target.
        time_step: s.
    """
    decay, share = _decay(target, time_constant, time_step)
    gained = torch.cat([target[:, :1], ((1.0 - decay) * target)[:, 1:]], dim=1)
    ends = (
        _filtered(decay, gained)
        if _is_one_number(decay, target)
        else accumulated(decay.expand_as(target), gained)
    )
    starts = torch.cat([target[:, :1], ends[:, :-1]], dim=1)
    return target + share * (starts - target)


def lag_of_samples(series: Series, start: Signal, time_constant: float | Signal, time_step: float) -> Series:
    """Return y of dy/dt = (series − y) / time_constant at the samples of recorded blocks.

    Exact for a series that runs straight between samples. At a time constant of 0 it is the series.

    Args:
        series: (blocks, samples, ...), any unit.
        start: y at the first sample, (blocks, ...).
        time_constant: s; one number, or a tensor that broadcasts with the series.
        time_step: s.
    """
    decay, share = _decay(series, time_constant, time_step)
    gained = (share - decay) * series[:, :-1] + (1.0 - share) * series[:, 1:]
    gained = torch.cat([start[:, None], gained], dim=1)
    if _is_one_number(decay, gained):
        return _filtered(decay, gained)
    return accumulated(decay.expand_as(series), gained)


def _is_one_number(decay: Tensor, target: Tensor) -> bool:
    """Whether the decay is one number, no gradients are asked for, and the data are on the processor."""
    return decay.numel() == 1 and not (decay.requires_grad or target.requires_grad) and not target.is_cuda


def _filtered(decay: Tensor, gained: Tensor) -> Tensor:
    """Return `accumulated` for one decay, by SciPy's recursive filter in place of passes over all samples."""
    from scipy.signal import lfilter  # its import takes longer than all effects

    return torch.from_numpy(lfilter([1.0], [1.0, -float(decay)], gained.numpy(), axis=1)).to(gained.dtype)


def _decay(like: Tensor, time_constant: Tensor | float, time_step: float) -> tuple[Tensor, Tensor]:
    """Return the remaining share of a deviation at the end of a step, and its mean over the step."""
    steps = torch.as_tensor(time_constant, dtype=like.dtype, device=like.device) / time_step
    decay = torch.where(steps > _FORGOTTEN, torch.exp(-1.0 / steps.clamp_min(_FORGOTTEN)), 0.0)
    return decay, steps * (1.0 - decay)
