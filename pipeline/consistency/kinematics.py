"""Rates against the derivatives of their positions: exact relations, for which no platform is needed."""

from collections.abc import Iterator

import numpy as np

from simgap.consistency.redundancy import CLEAR, Pair
from simgap.consistency.samples import Samples

_TURN = 2.0 * np.pi
_LEAST_SPEED = 0.02  # m/s: an estimate of a velocity drifts by as much
_LEAST_TURNING = 0.02  # rad/s


def position_pairs(samples: Samples) -> Iterator[Pair]:
    """Yield every comparison of a rate with the derivative of its position."""
    if samples.kind == "joint":
        yield rate_pair(samples, "velocity", "position", 0.0)
    elif samples.kind == "swerve":
        for module in "1234":
            yield rate_pair(
                samples, f"steer_velocity_{module}", f"steer_angle_{module}", _LEAST_TURNING, True
            )
    else:
        for axis in "xyz":
            yield rate_pair(samples, f"velocity_{axis}", f"position_{axis}", _LEAST_SPEED)


def servo_pairs(samples: Samples) -> Iterator[Pair]:
    """Yield what a servo was told against where it went, as rates: a load shifts where it rests."""
    told, gone = samples["position_command"], samples["position"]
    noise = max(samples.noise_of_rate(told), samples.noise_of_rate(gone))
    columns = ("position_command", "position")
    name = "the motion of 'position' against that of 'position_command'"
    # A weak or a slow servo follows little, but never the other way round, nor many times as far.
    yield Pair(name, columns, samples.rate(told), samples.rate(gone), noise, CLEAR)


def rate_pair(samples: Samples, rate: str, position: str, least: float, wraps: bool = False) -> Pair:
    """Compare a rate with the derivative of a position.

    Args:
        samples: of the recording.
        rate: column.
        position: column.
        least: see `Pair`.
        wraps: whether the position is an angle that may jump by a turn.
    """
    values, angle = samples[rate], samples[position]
    derived = samples.rate(_unwrapped(angle) if wraps else angle)
    noise = max(least, samples.noise_of_mean(values), samples.noise_of_rate(angle))
    name = f"{rate!r} against the rate of change of {position!r}"
    return Pair(name, (rate, position), samples.mean(values), derived, noise)


def _unwrapped(angle: np.ndarray) -> np.ndarray:
    """Return an angle without jumps by a turn, where it stays within one turn."""
    if not np.nanmax(np.abs(angle), initial=0.0) <= _TURN * 1.01:
        return angle
    known = np.isfinite(angle)
    result = angle.copy()
    result[known] = np.unwrap(angle[known])
    return result
