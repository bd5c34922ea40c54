"""Idle stretches: no input and no motion, or a quadrotor on the ground."""

from functools import reduce

import numpy as np

from simgap.recordings.cleaning.channels import (
    BODY_RATE,
    INPUTS,
    MOTOR_COMMAND,
    MOTOR_SPEED,
    POSITION,
    RATES,
    VELOCITY,
)
from simgap.recordings.cleaning.work import RunUnderCleaning, stretches_of

_OFF = 0.4  # of the typical rotor speed or command in flight; a rotor at idle turns at about 0.3
_ON_FLOOR = 0.1  # m above the lowest height: a landing bounces
_RESTING = 0.03  # m
_STILL_SPEED = 0.05  # m/s
_STILL_RATE = 0.1  # rad/s
_NO_INPUT = 0.01  # of the largest input
_NO_MOTION = 0.01  # of the largest speed
_SETPOINTS = frozenset({"position_command"})  # whose zero is a place, not the absence of an input


def drop_idle(run: RunUnderCleaning, min_idle: float) -> None:
    """Drop what lasts at least `min_idle` s without input and motion (swerve, joint) or on the ground
    (quadrotor)."""
    if run.kind == "quadrotor":
        off = _rotors_off(run)
        if run.has(POSITION):
            resting, on_floor = _resting(run), _height(run) < _ON_FLOOR
            _drop(run, off | resting, min_idle, off & on_floor | resting, "on the ground, not flying")
        _drop(run, off, max(min_idle, 1.0), off, "rotors off")
        return
    inputs = [column for column in INPUTS[run.kind] if column in run.columns and column not in _SETPOINTS]
    rates = [column for column in RATES[run.kind] if column in run.columns]
    if not inputs or not rates:
        return  # a servo that holds a position works, and without a rate nothing shows standstill
    still = np.logical_and.reduce(
        [_below_share(run.column(column), _NO_INPUT) for column in inputs]
        + [_below_share(run.column(column), _NO_MOTION) for column in rates]
    )
    _drop(run, still, min_idle, still, "no input on any motor and no motion")


def _drop(run: RunUnderCleaning, rest: np.ndarray, least: float, wanted: np.ndarray, reason: str) -> None:
    rows = np.zeros(len(run.time), dtype=bool)
    gone = run.dropped > 0  # what was cut out of a rest does not make it shorter
    for first, past in stretches_of(rest | gone):
        if run.time[past - 1] - run.time[first] + run.time_step >= least:
            rows[first:past] = True
    run.drop(rows & wanted, "idle", reason)


def _below_share(values: np.ndarray, share: float) -> np.ndarray:
    """Return where a channel is not above a share of its largest size, (samples,); a missing value is not."""
    size = np.abs(values)
    largest = np.where(np.isfinite(size), size, 0.0).max(initial=0.0)
    return ~(size > share * largest)


def _rotors_off(run: RunUnderCleaning) -> np.ndarray:
    groups = [group for group in (MOTOR_SPEED, MOTOR_COMMAND) if run.has(group)]
    known = [group for group in groups if any(np.isfinite(run.column(name)).any() for name in group)]
    if not known:
        return np.zeros(len(run.time), dtype=bool)
    strongest = reduce(np.maximum, [run.column(name) for name in known[0]])
    finite = strongest[np.isfinite(strongest)]
    typical = float(np.quantile(finite, 0.75, overwrite_input=True)) if len(finite) else 0.0
    return strongest < _OFF * typical


def _height(run: RunUnderCleaning) -> np.ndarray:
    height = run.column("position_z")
    return height - np.nanmin(height)


def _resting(run: RunUnderCleaning) -> np.ndarray:
    speed, rate = run.length(VELOCITY), run.length(BODY_RATE)
    with np.errstate(invalid="ignore"):
        return (_height(run) < _RESTING) & (speed < _STILL_SPEED) & (rate < _STILL_RATE)
