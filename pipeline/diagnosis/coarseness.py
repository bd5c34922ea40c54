"""Axes that settle within about two samples, so that the recording does not resolve their motion."""

from collections.abc import Mapping, Sequence

from simgap.equations.fit import Fit, excess_of
from simgap.equations.problem import Problem
from simgap.gap.settings import BEYOND_NOISE
from simgap.platforms.mechanism import Channel

_COARSE_SHARE = 0.5  # time step over settling time, above which samples do not resolve the motion


def coarse_axes(fit: Fit, problem: Problem, channels: Sequence[Channel]) -> dict[str, float]:
    """Return the settling times, s, of coarsely sampled axes that leave more than noise, by channel.

    Where only noise is left, the fit explains the samples.
    """
    rates = fit.simulator.mechanism.damping(fit.simulator.constants())
    left = excess_of(fit, problem.noise).tolist()
    return {
        channel.name: 1.0 / rates[channel.name]
        for channel, energy in zip(channels, left, strict=True)
        if energy > BEYOND_NOISE and rates.get(channel.name, 0.0) * problem.blocks.time_step > _COARSE_SHARE
    }


def coarseness_of(axes: Mapping[str, float], time_step: float) -> list[str]:
    """Return a sentence about each coarsely sampled axis.

    Args:
        axes: seconds within which they settle, by channel.
        time_step: between samples, s.
    """
    return [
        f"{name}: the axis settles within {seconds:.2g} s, but samples are {time_step:.2g} s apart, so friction, dead "
        "zone and inertia can be confused; record at a higher rate"
        for name, seconds in axes.items()
    ]
