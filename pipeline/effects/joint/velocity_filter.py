"""Low-pass filter of the recorded velocity of a joint.

Drives average or filter the velocity that they report, or differentiate the position over a window. It is then late;
the position is not.

The inverse of the filter, velocity + time_constant · d(velocity)/dt, multiplies the noise of the velocity by
time_constant over the time step. The position knows better what the filter took away. In terms of true motion, the
recorded velocity v and position p obey v = d(lag(p))/dt, hence d(p)/dt = v + d(p − lag(p))/dt. The velocity itself
gives the slow part, the position the fast part: a complementary filter. Its noise is never larger than that of the
differentiated position, whatever the time constant. The derivative is of fourth order; in the equations of motion it
stands under a smooth window.
"""

import torch

from simgap.effects.effect import MeasurementEffect, Parameter, Signals, Values
from simgap.effects.lag import lag_of_samples
from simgap.physics.shapes import Series, Signal

_SHORTEST_FOURTH_ORDER = 5  # samples of the five-point stencil


class VelocityFilter(MeasurementEffect):
    """The velocity is recorded through a low-pass filter and is late; the position is not."""

    name = "velocity_filter"
    kind = "joint"
    acts_on = "measurement"
    parameters = (Parameter("time_constant", "s", 0.02, 0.0, 0.5),)
    needs = ("position", "velocity")
    excluded_by = ("derived_velocity",)  # nobody filtered what was derived from the position
    formula = "d(velocity_recorded)/dt = (velocity − velocity_recorded) / time_constant"
    source = (
        "Franklin, Powell & Emami-Naeini 2019, §3.3: first-order response; Higgins 1975, A comparison of complementary "
        "and Kalman filtering (IEEE Trans. Aerosp. Electron. Syst. 11), for the inverse"
    )
    sentence = (
        "The velocity is recorded through a filter of {time_constant} s, the position is not; correct the velocity "
        "before you fit anything, or differentiate the position."
    )
    excitation = (
        "reverse quickly, or run a fast chirp, so that the position shows the velocity that was filtered"
    )
    symptom = "The recorded velocity lags behind the slope of the position and is smaller in fast motion."
    look_alikes = ("sensor_time_offset",)

    def starts(self) -> list[dict[str, float]]:
        """Start from none, and from a scan over the decades."""
        return [{"time_constant": constant} for constant in (0.0, 0.002, 0.01, 0.05, 0.2)]

    def lateness(self, values: Values, constants: Values) -> float:
        """Return the time constant."""
        return float(values["time_constant"])

    def undo(self, signals: Signals, values: Values, time_step: float) -> dict[str, Signal]:
        """Return the velocity without the filter: add the part of the position that the filter took away.

        Signals of the commands alone stay as they are.
        """
        if "velocity" not in signals:
            return dict(signals)
        velocity, constant = signals["velocity"], values["time_constant"]
        position = _going_on(signals, time_step)
        # The filtered position runs behind by just what the filtered velocity covers in a time constant.
        start = position[:, 0] - constant * velocity[:, 0]
        taken = position - lag_of_samples(position, start, constant, time_step)
        return {**signals, "velocity": velocity + _slope(taken, time_step)}


def _going_on(signals: Signals, time_step: float) -> Series:
    """Return the position (blocks, samples), which goes on at its velocity where a block repeats its last sample.

    A margin beyond the end of a recording does that; its time (`elapsed`) stands still there, in the middle never.
    """
    position = signals["position"]
    if "elapsed" not in signals:
        return position
    place = torch.arange(position.shape[1], dtype=position.dtype, device=position.device)
    repeated = place - signals["elapsed"] / time_step
    beyond = repeated - repeated[:, position.shape[1] // 2, None]
    return position + beyond * time_step * signals["velocity"]


def _slope(series: Series, time_step: float) -> Series:
    """Return the time derivative of blocks (blocks, samples): five-point differences, lower order at the ends.

    Source: Fornberg 1988, Generation of finite difference formulas on arbitrarily spaced grids, table 1.
    """
    if series.shape[1] < 2:
        return torch.zeros_like(series)
    (slope,) = torch.gradient(series, spacing=time_step, dim=1)
    if series.shape[1] < _SHORTEST_FOURTH_ORDER:
        return slope
    near = series[:, 3:-1] - series[:, 1:-3]
    far = series[:, 4:] - series[:, :-4]
    inner = (8.0 * near - far) / (12.0 * time_step)
    return torch.cat([slope[:, :2], inner, slope[:, -2:]], dim=1)
