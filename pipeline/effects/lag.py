"""First-order lags of recorded series: between means over the same steps, and between samples.

Source: Krishnan 2001, Electric motor drives, §2; Franklin, Powell & Workman 1998, Digital control of dynamic systems,
§6.3 (equivalents by hold). Neither adds a delay of its own.
"""

import torch
from torch import Tensor

from simgap.effects.recurrence import accumulated
from simgap.physics.shapes import Real, Series, Signal, Value
from simgap.physics.tracing import may_run_compiled

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


def uneven_lag_step(start: Real, target: Real, up: Value, down: Value, time_step: float) -> tuple[Real, Real]:
    """Return the mean and the end of `lag_step` with one time constant for rising and one for falling.

    Within a step the target is held and never crossed, so that each step has one of them.

    Args:
        start: y at the start of the step, any unit.
        target: held over the step.
        up: time constant where y rises, s.
        down: time constant where y falls, s.
        time_step: s.
    """
    (decay_up, share_up), (decay_down, share_down) = (_decay(target, t, time_step) for t in (up, down))
    rising = target > start
    decay = torch.where(rising, decay_up, decay_down)
    share = torch.where(rising, share_up, share_down)
    return target + share * (start - target), target + decay * (start - target)


def uneven_lag_along_time(target: Series, up: Value, down: Value, time_step: float) -> Series:
    """Return the means of `uneven_lag_step` along recorded blocks, settled at their first sample.

    Whether a step rises depends on the samples before it, so that they are followed one by one.

    Args:
        target: (blocks, samples, ...).
        up: time constant where y rises, s.
        down: time constant where y falls, s.
        time_step: s.
    """
    (decay_up, share_up), (decay_down, share_down) = (_decay(target, t, time_step) for t in (up, down))
    if may_run_compiled((target,), (up, down)) and target.dtype == torch.float64:
        starts = _starts_compiled(target, float(decay_up), float(decay_down))
    else:
        starts = _starts_one_by_one(target, decay_up, decay_down)
    behind = starts - target
    return target + torch.where(behind < 0, share_up, share_down) * behind


def _starts_compiled(target: Tensor, decay_up: float, decay_down: float) -> Tensor:
    from simgap.physics.lag_steps import starts_along  # its import takes longer than all effects

    series = target.reshape(*target.shape[:2], -1).contiguous()
    return torch.from_numpy(starts_along(series.numpy(), decay_up, decay_down)).reshape(target.shape)


def _starts_one_by_one(target: Tensor, decay_up: Tensor, decay_down: Tensor) -> Tensor:
    starts, start = [], target[:, 0]
    for held in target.movedim(1, 0).contiguous():
        starts.append(start)
        above = held - start
        start = torch.addcmul(held, above, torch.where(above > 0, decay_up, decay_down), value=-1.0)
    return torch.stack(starts, dim=1)


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
    """Whether the decay is one number, and nobody asks for more than the numbers of the series."""
    return decay.numel() == 1 and may_run_compiled((decay, target))


def _filtered(decay: Tensor, gained: Tensor) -> Tensor:
    """Return `accumulated` for one decay, by SciPy's recursive filter in place of passes over all samples."""
    from scipy.signal import lfilter  # its import takes longer than all effects

    return torch.from_numpy(lfilter([1.0], [1.0, -float(decay)], gained.numpy(), axis=1)).to(gained.dtype)


def _decay(like: Tensor, time_constant: Tensor | float, time_step: float) -> tuple[Tensor, Tensor]:
    """Return the remaining share of a deviation at the end of a step, and its mean over the step."""
    steps = torch.as_tensor(time_constant, dtype=like.dtype, device=like.device) / time_step
    decay = torch.where(steps > _FORGOTTEN, torch.exp(-1.0 / steps.clamp_min(_FORGOTTEN)), 0.0)
    return decay, steps * (1.0 - decay)
