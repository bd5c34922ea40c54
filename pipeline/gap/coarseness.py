"""Axes that settle about as fast as they were sampled: what happens between samples decides what they show."""

from collections.abc import Mapping, Sequence

from simgap.gap.candidate import BEYOND_NOISE
from simgap.gap.fit import Fit, Problem, excess_of
from simgap.platforms.mechanism import Channel

_COARSE_SHARE = (
    0.5  # of the time in which an axis settles, from which on samples are too far apart to show how it does
)


def coarse_axes(fit: Fit, problem: Problem, channels: Sequence[Channel]) -> dict[str, float]:
    """Return within how many seconds axes settle that were sampled coarsely and leave more than noise, by channel.

    Where nothing but noise is left, what is in the fit explains the samples as they are.
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
        f"{name}: what moves settles within {seconds:.2g} s, and samples are {time_step:.2g} s apart: friction, dead "
        "zones and inertia may pass for each other; record more often"
        for name, seconds in axes.items()
    ]
