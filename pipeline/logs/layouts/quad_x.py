"""How the motors of a quad X turn it, in the order that Betaflight and INAV number them.

Source: betaflight.com/docs/wiki/guides/current/Reversed-motor-direction; the firmware's mixer QUADX.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simgap.logs.common_times import step_of
from simgap.logs.layouts.airframes import BETAFLIGHT_X, directions, mixer_of, reversed_
from simgap.logs.log import Span

_USUAL, _REVERSED = directions(BETAFLIGHT_X), directions(reversed_(BETAFLIGHT_X))
_MIXER = np.array(mixer_of(BETAFLIGHT_X))
_BAND = (1.0, 30.0)  # Hz: faster than drag and wind, slower than the propellers
_LAGS = (0.004, 0.06)  # s after which motors act; earlier, it is the controller that answers to the rate
_TELLING = 0.25  # correlation from which a direction is believed
_FEWEST, _MOST = 200, 200_000  # samples of a flight that are compared; more of them would say the same


@dataclass(frozen=True)
class Turning:
    """Correlation of what the motors ask for with the angular acceleration that follows, about x, y and z.

    Attributes:
        correlation: NaN where the log does not show it.
    """

    correlation: tuple[float, float, float]

    def agrees(self, axis: int) -> bool:
        """Whether the machine turns about an axis as its mixer says."""
        return self.correlation[axis] > _TELLING

    def opposes(self, axis: int) -> bool:
        """Whether it turns the other way."""
        return self.correlation[axis] < -_TELLING


def turning_of(
    time: NDArray[np.float64],
    rate: NDArray[np.float64],
    command: NDArray[np.float64],
    flights: Sequence[Span],
) -> Turning:
    """Compare the motors with the rotation that they cause.

    Args:
        time: s, (samples,).
        rate: body rates, rad/s, (samples, 3).
        command: of the motors, 0 to 1, (samples, 4).
        flights: where they carry the machine.
    """
    from scipy.signal import butter, sosfiltfilt

    step = step_of(time)
    lags = [round(lag / step) for lag in np.linspace(*_LAGS, 15)]
    moments = np.zeros((len(lags), 3, 3))  # of asked, answered, and both
    if _BAND[1] >= 0.4 / step:
        return Turning((float("nan"),) * 3)
    band = butter(2, _BAND, "band", fs=1.0 / step, output="sos")
    for flight in flights:
        mine = np.flatnonzero((time >= flight.begin) & (time <= flight.end))[:_MOST]
        if len(mine) < _FEWEST:
            continue
        asked = sosfiltfilt(band, command[mine] ** 2 @ _MIXER.T, axis=0)
        answered = sosfiltfilt(band, np.gradient(rate[mine], step, axis=0), axis=0)
        for place, lag in enumerate(lags):
            before, after = asked[: len(asked) - lag], answered[lag:]
            moments[place] += [(before**2).sum(0), (after**2).sum(0), (before * after).sum(0)]
    size = np.sqrt(moments[:, 0] * moments[:, 1])
    correlation = np.where(size > 0, moments[:, 2] / np.where(size > 0, size, 1.0), np.nan)
    strongest = np.abs(np.nan_to_num(correlation)).argmax(axis=0)
    x, y, z = (float(correlation[place, axis]) for axis, place in enumerate(strongest))
    return Turning((x, y, z))


def directions_of(turning: Turning) -> str:
    """Return a sentence that says which `rotor_directions` the platform file has to have."""
    if turning.agrees(2):
        return f"The motors turn as is usual (propellers inwards): rotor_directions {_USUAL}."
    if turning.opposes(2):
        turned = "in reverse (propellers outwards, yaw_motors_reversed)"
        return f"The motors turn {turned}: rotor_directions {_REVERSED}."
    return (
        f"Which way the motors turn does not show: rotor_directions is {_USUAL} as is usual (propellers inwards), "
        f"or {_REVERSED} if yaw_motors_reversed is on."
    )
