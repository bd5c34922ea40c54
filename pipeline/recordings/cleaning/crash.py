"""Cut a flight before its crash."""

import numpy as np

from simgap.recordings.cleaning.channels import ATTITUDE, BODY_RATE, POSITION, SPECIFIC_FORCE, VELOCITY
from simgap.recordings.cleaning.work import RunUnderCleaning

_GRAVITY = 9.81  # m/s²
_RECOVERY = 3.0  # s of flight without any sign of a crash: then it was none
_TIMES_USUAL = 3.0
_SIGNS = {  # the slightest that counts (m/s, rad/s, m/s², m), and the quantile of a flight that is its usual
    "speed": (3.0, 0.9),  # an estimate that is lost runs away for long, a shock is short
    "body rate": (12.0, 0.98),
    "specific force": (2.0 * _GRAVITY, 0.98),
    "position jump": (1.0, 0.9),
}
_JUMP_TIME = 0.5  # s within which a position jumps
_UPSIDE_DOWN = -0.2  # cosine of the tilt
_ON_FLOOR = 0.1  # m above the lowest height
_TOUCHDOWN_MARGIN = 0.05  # s


def cut_crash(run: RunUnderCleaning, margin: float) -> None:
    """Drop everything from `margin` s before the first sign of a crash from which the flight did not recover.

    Signs, each relative to the rest of the flight: speed, body rate or specific force far above the usual,
    upside down, the position jumping where the velocity does not (the estimate is lost). After a sign that is
    followed by 3 s of flight without another, nothing was wrong. A shock on the floor that ends the flight is
    a hard landing, and costs no margin.
    """
    if run.kind != "quadrotor" or len(run.time) < 3:
        return
    signs = _signs(run)
    onset = _onset(run.time, np.logical_or.reduce(list(signs.values())))
    if onset is None:
        return
    landed = run.has(POSITION) and _stays_low(run.column("position_z"), onset)
    reason = "on the ground after a hard landing" if landed else "crashed or lost control"
    seen = ", ".join(name for name, mask in signs.items() if mask[onset:].any())
    start = run.time[onset] - (_TOUCHDOWN_MARGIN if landed else margin)
    run.drop(run.time >= start, "crash", reason, f"first sign at t = {run.time[onset]:.6g} s: {seen}")


def _stays_low(height: np.ndarray, onset: int) -> bool:
    """Return whether the flight is near its lowest height from a sample on."""
    return bool(np.nanmax(height[onset:], initial=-np.inf) < np.nanmin(height) + _ON_FLOOR)


def _signs(run: RunUnderCleaning) -> dict[str, np.ndarray]:
    """Return a mask per sign that the recording can show, each of shape (samples,)."""
    located, signs = run.has(POSITION), {}
    if located:
        signs["speed"] = _far_above(run.length(VELOCITY), "speed")
    signs["body rate"] = _far_above(run.length(BODY_RATE), "body rate")
    if located:
        signs["position jump"] = _far_above(_position_jump(run), "position jump")
    if run.has(SPECIFIC_FORCE):
        excess = np.abs(run.length(SPECIFIC_FORCE) - _GRAVITY)
        signs["specific force"] = _far_above(excess, "specific force")
    if run.has(ATTITUDE):
        x, y = (run.column(name) for name in ATTITUDE[1:3])
        with np.errstate(invalid="ignore"):
            upward = 1.0 - 2.0 * (x**2 + y**2)  # z of the body's z axis in the world
            signs["upside down"] = upward < _UPSIDE_DOWN
    return signs


def _far_above(size: np.ndarray, sign: str) -> np.ndarray:
    slightest, quantile = _SIGNS[sign]
    if not np.fmax.reduce(size, initial=0.0) > slightest:
        return np.zeros(len(size), dtype=bool)
    known = size[np.isfinite(size)]
    usual = float(np.quantile(known, quantile)) if len(known) else np.inf
    with np.errstate(invalid="ignore"):
        return size > max(slightest, _TIMES_USUAL * usual)


def _position_jump(run: RunUnderCleaning) -> np.ndarray:
    """Way of the position within `_JUMP_TIME` beyond what the velocity accounts for, m."""
    back = max(1, round(_JUMP_TIME / run.time_step))
    time_step, other = np.diff(run.time), run.stretch[1:] != run.stretch[:-1]
    squared, drift = np.zeros(len(run.time)), np.empty(len(run.time))
    for names in zip(POSITION, VELOCITY, strict=True):
        position, velocity = (run.column(name) for name in names)
        told = velocity[1:] + velocity[:-1]
        told *= 0.5
        told *= time_step
        step = np.diff(position)
        step -= told
        step[other | np.isnan(step)] = 0.0
        drift[0] = 0.0
        np.cumsum(step, out=drift[1:])
        drift[back:] -= drift[:-back].copy()  # before `back` samples have passed, since the first one
        squared += np.square(drift, out=drift)
    return np.sqrt(squared, out=squared)


def _onset(time: np.ndarray, alarm: np.ndarray) -> int | None:
    """Return the first alarm of the last series of alarms if no `_RECOVERY` s are left after it, else
    None."""
    rows = np.flatnonzero(alarm)
    if not len(rows) or time[-1] - time[rows[-1]] >= _RECOVERY:
        return None
    breaks = np.flatnonzero(np.diff(time[rows]) >= _RECOVERY)
    return int(rows[breaks[-1] + 1] if len(breaks) else rows[0])
