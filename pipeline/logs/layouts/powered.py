"""Where a log holds flights: the motors carry the machine, and the throttle is up."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from simgap.logs.common_times import step_of
from simgap.logs.log import Log, Span

_SMOOTHED = 0.3  # s over which the commands are averaged
_CARRYING = 0.6  # of the typical command in the air; thrust goes with its square, so that less does not carry
_THROTTLE_UP = 1050.0  # µs of the stick, whose lowest position is 1000
_LONGEST_DIP = 1.0  # s without throttle within a flight: a flip or a dive
_SHORTEST = 2.0  # s of a flight
_ON_THE_GROUND = 0.5  # s at both ends: a machine that lifts off or touches down is pushed by the ground, too


def flights_of(log: Log, time: NDArray[np.float64], commands: NDArray[np.float64]) -> tuple[Span, ...]:
    """Return the flights of a log, in its clock.

    Args:
        log: with `rcCommand[3]`, the throttle, where that was logged.
        time: of the commands, (samples,), s, increasing.
        commands: of the motors, 0 to 1, (samples, motors).
    """
    step = step_of(time)
    level = _averaged(commands.mean(axis=1), max(round(_SMOOTHED / step), 1))
    throttle = log.signals.get("rcCommand[3]")
    up = np.ones(len(time), bool)
    if throttle is not None and len(throttle.time) == len(time):
        up = throttle.values > _THROTTLE_UP
    if not up.any():
        return ()
    carried = level > _CARRYING * float(np.median(level[up]))
    carried &= _averaged(up.astype(float), max(round(_LONGEST_DIP / step), 1)) > 0.0
    found = []
    for span in log.spans:
        within = (time >= span.begin) & (time <= span.end)
        found += _stretches(time[within], carried[within])
    return tuple(Span(f"flight {number}", *each) for number, each in enumerate(found, 1))


def full_thrust(
    time: NDArray[np.float64],
    force: NDArray[np.float64],
    commands: NDArray[np.float64],
    flights: Sequence[Span],
) -> float | None:
    """Return thrust_coefficient · motor_speed_max² / mass of a rotor, m/s², by the specific force that commands give.

    Args:
        time: s, (samples,).
        force: specific force along body z, m/s², (samples,).
        commands: of the motors, 0 to 1, (samples, motors).
        flights: where they carry the machine.
    """
    flown = np.zeros(len(time), bool)
    for flight in flights:
        flown |= (time >= flight.begin) & (time <= flight.end)
    asked = (commands[flown] ** 2).sum(axis=1)
    energy = float(asked @ asked)
    return float(asked @ force[flown]) / energy if energy > 0.0 else None


def _averaged(values: NDArray[np.float64], samples: int) -> NDArray[np.float64]:
    """Return the centred moving average; the ends are averages of what is there."""
    half, place = samples // 2, np.arange(len(values))
    total = np.zeros(len(values) + 1)
    np.cumsum(values, out=total[1:])
    total = np.pad(total, half, mode="edge")
    count = np.minimum(place + half + 1, len(values)) - np.maximum(place - half, 0)
    return np.asarray((total[2 * half + 1 :] - total[: len(values)]) / count)


def _stretches(time: NDArray[np.float64], carried: NDArray[np.bool_]) -> list[tuple[float, float]]:
    """Return begin and end of each stretch in the air, over short dips, if it is long enough."""
    rows = np.flatnonzero(carried)
    if not len(rows):
        return []
    breaks = np.flatnonzero(np.diff(time[rows]) > _LONGEST_DIP)
    firsts, lasts = rows[np.append(0, breaks + 1)], rows[np.append(breaks, len(rows) - 1)]
    pairs = [
        (float(time[first]) + _ON_THE_GROUND, float(time[last]) - _ON_THE_GROUND)
        for first, last in zip(firsts, lasts, strict=True)
    ]
    return [pair for pair in pairs if pair[1] - pair[0] >= _SHORTEST]
