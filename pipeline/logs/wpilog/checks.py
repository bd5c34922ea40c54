"""What signals of a motor say of each other: how fast it would turn at 12 V, and whether it moves at all."""

from collections.abc import Iterable

import numpy as np

from simgap.logs.common_times import step_of, values_at
from simgap.logs.log import Signal

_SUPPLY = 12.0  # V
_MOVING = 0.1  # of the greatest speed: below, friction takes most of the voltage
_FEWEST = 50  # samples in motion: a second of a robot's program


def moves(signals: Iterable[Signal]) -> bool:
    """Return whether any of several signals takes more than one value."""
    return any(len(np.unique(signal.values[np.isfinite(signal.values)])) > 1 for signal in signals)


def speed_at_supply(voltage: Signal, velocity: Signal) -> float | None:
    """Return the speed at 12 V, in the unit of the velocity; None where the motor hardly moves.

    It is that of V = kV·v + kA·dv/dt, by least squares.
    """
    time, speed = velocity.time, velocity.values
    if len(time) < _FEWEST:
        return None
    volts = values_at(voltage, time, held=True)
    usable = np.isfinite(volts) & np.isfinite(speed)
    rate = np.gradient(np.where(usable, speed, 0.0), time)
    usable &= np.abs(speed) > _MOVING * np.nanmax(np.abs(speed), initial=0.0)
    usable &= np.gradient(time) < 5.0 * step_of(time)  # a pause is no acceleration
    if np.count_nonzero(usable) < _FEWEST:
        return None
    table = np.column_stack([speed, rate])[usable]
    gain = float(np.linalg.lstsq(table, volts[usable], rcond=None)[0][0])
    return _SUPPLY / gain if gain > 0 else None
