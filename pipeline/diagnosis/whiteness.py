"""Whiteness of the remaining residual: its correlation with its own past and with past inputs.

Ljung 1999, System Identification, §16.6: the tests of whiteness, and of independence of residuals and past inputs.
Their bands assume independent errors; here products are summed over stretches of a run, which may be correlated inside
themselves, and the stretches' own spread gives the bands.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from scipy import stats
from torch import Tensor

from simgap.equations.problem import Problem
from simgap.physics.weak_form import mean_of
from simgap.platforms.mechanism import Channel

_WHITENESS_LEVEL = 1e-3  # level of the test, over all channels, inputs and lags
_NOTABLE_CORRELATION = 0.1  # least correlation of a warning
_INPUTS = (
    *("effort", "voltage", "position_command"),
    *("rotor_command", "rotor_speed", "drive_voltage", "steer_voltage"),
)


@dataclass(frozen=True)
class Memory:
    """A correlation of the remaining residual of a channel with its past or a past input.

    Attributes:
        channel: whose residual.
        of: `itself`, or the input that it follows.
        lag: s by which the other is earlier.
        correlation: −1..1.
        band: ± what independent stretches would show by chance, 95 %.
        p_value: two-sided t test over stretches.
    """

    channel: Channel
    of: str
    lag: float
    correlation: float
    band: float
    p_value: float

    @property
    def sentence(self) -> str:
        """The meaning in one line."""
        past = "its own value" if self.of == "itself" else self.of
        return (
            f"the remaining error of {self.channel.name} correlates with {past} {self.lag:.2g} s earlier "
            f"({self.correlation:+.2f}, by chance ±{self.band:.2f}): the simulator lacks an effect with memory, or an "
            "input was not recorded"
        )


def memories_of(residual: Tensor, channels: Sequence[Channel], problem: Problem) -> list[Memory]:
    """Return every correlation of residuals with their own past and with past inputs that can be told from rows.

    Windows that overlap share samples, so that a residual is compared with its past from two windows before on. Only
    the past of an input counts: in closed loop its future answers to the residual.

    Args:
        residual: (blocks, rows, channels).
        channels: names and units.
        problem: blocks, windows and clusters.
    """
    found = []
    inputs = _inputs(problem)
    for place, channel in enumerate(channels):
        left = residual[..., place]
        for lag in range(2, left.shape[1] - 1):
            found.append(_memory(channel, "itself", left, left, lag, problem))
        for name, series in inputs.items():
            for lag in range(left.shape[1] - 1):
                found.append(_memory(channel, name, left, series, lag, problem))
    return found


def remembered(found: Sequence[Memory]) -> list[Memory]:
    """Return the strongest memory of each channel that is notable and beyond chance, the strongest channel first."""
    sure = [
        m
        for m in found
        if m.p_value < _WHITENESS_LEVEL / len(found) and abs(m.correlation) > _NOTABLE_CORRELATION
    ]
    strongest: dict[str, Memory] = {}
    for memory in sorted(sure, key=lambda m: abs(m.correlation)):
        strongest[memory.channel.name] = memory
    return sorted(strongest.values(), key=lambda m: -abs(m.correlation))


def _inputs(problem: Problem) -> dict[str, Tensor]:
    """Return what was commanded, averaged over the windows and without its mean, (blocks, rows) each."""
    blocks = problem.blocks
    averaged = {}
    for name in _INPUTS:
        if name not in blocks.signals:
            continue
        series = blocks.inner(blocks.signals[name])
        columns = [series] if series.ndim == 2 else list(series.unbind(-1))
        for number, column in enumerate(columns, start=1):
            mean = mean_of(problem.functions, column)
            averaged[name if series.ndim == 2 else f"{name}_{number}"] = mean - mean.mean()
    return {name: series for name, series in averaged.items() if float(series.std()) > 0}


def _memory(channel: Channel, of: str, left: Tensor, other: Tensor, lag: int, problem: Problem) -> Memory:
    """Correlate the later rows of each block with the earlier rows of another series."""
    functions, blocks = problem.functions, problem.blocks
    product = (left[:, lag:] * other[:, : other.shape[1] - lag]).sum(1)
    clusters = int(problem.cluster.max()) + 1
    summed = product.new_zeros(clusters).index_add(0, problem.cluster, product)
    size = float((left[:, lag:].square().sum() * other[:, : other.shape[1] - lag].square().sum()).sqrt())
    total, error = float(summed.sum()), float(summed.std()) * clusters**0.5 if clusters > 1 else float("inf")
    statistic = abs(total) / max(error, 1e-300)
    step = float(functions.centres[1] - functions.centres[0]) * blocks.time_step
    return Memory(
        channel=channel,
        of=of,
        lag=lag * step,
        correlation=total / max(size, 1e-300),
        band=1.96 * error / max(size, 1e-300),
        p_value=float(2.0 * stats.t.sf(statistic, max(clusters - 1, 1))),
    )
