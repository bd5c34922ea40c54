"""Cut a flight off before it crashed."""

import numpy as np

from pipeline.recordings.cleaning.channels import ATTITUDE, BODY_RATE, POSITION, SPECIFIC_FORCE, VELOCITY
from pipeline.recordings.cleaning.work import RunUnderCleaning

_GRAVITY = 9.81  # m/s²
_RECOVERY = 3.0  # s of flight without any sign of a crash: then it was none
_USUAL = 0.98  # quantile of a flight that is taken as usual
_TIMES_USUAL = 3.0
_SLIGHTEST = {
    "speed": 3.0,
    "body rate": 12.0,
    "specific force": 2.0 * _GRAVITY,
    "position jump": 3.0,
}  # m/s, rad/s, m/s², m/s
_UPSIDE_DOWN = -0.2  # cosine of the tilt
_RARE = 0.02  # share of the flight; more is acrobatics


def cut_crash(run: RunUnderCleaning, margin: float) -> None:
    """Drop everything from `margin` s before the first sign of a crash from which the flight did not recover.

    Signs, each relative to the rest of the flight: speed, body rate or specific force far above the usual, upside down,
    position jumping where the velocity does not (the estimate is lost). After a sign that is followed by 3 s of flight
    without another, nothing was wrong.
    """
    if run.kind != "quadrotor" or len(run.time) < 3:
        return
    signs = _signs(run)
    alarm = np.any(list(signs.values()), axis=0)
    onset = _onset(run.time, alarm)
    if onset is None:
        return
    seen = [name for name, mask in signs.items() if mask[onset:].any()]
    start = run.time[onset] - margin
    detail = f"first sign at t = {run.time[onset]:.6g} s: {', '.join(seen)}"
    run.drop(run.time >= start, "crash", "crashed or lost control", detail)


def _signs(run: RunUnderCleaning) -> dict[str, np.ndarray]:
    """Return a mask per sign, each of shape (samples,)."""
    speed = np.linalg.norm(run.channel(*VELOCITY), axis=1)
    signs = {
        "speed": _far_above(speed, "speed"),
        "body rate": _far_above(np.linalg.norm(run.channel(*BODY_RATE), axis=1), "body rate"),
        "position jump": _far_above(_position_jump(run), "position jump"),
    }
    if run.has(SPECIFIC_FORCE):
        excess = np.abs(np.linalg.norm(run.channel(*SPECIFIC_FORCE), axis=1) - _GRAVITY)
        signs["specific force"] = _far_above(excess, "specific force")
    _, x, y, _ = run.channel(*ATTITUDE).T
    upside_down = 1.0 - 2.0 * (x**2 + y**2) < _UPSIDE_DOWN  # z component of body z in the world
    signs["upside down"] = upside_down if upside_down.mean() > 0 else np.zeros(len(run.time), dtype=bool)
    return signs


def _far_above(size: np.ndarray, sign: str) -> np.ndarray:
    known = size[np.isfinite(size)]
    usual = float(np.quantile(known, _USUAL)) if len(known) else np.inf
    with np.errstate(invalid="ignore"):
        return size > max(_SLIGHTEST[sign], _TIMES_USUAL * usual)


def _position_jump(run: RunUnderCleaning) -> np.ndarray:
    """Speed of the position beyond what the velocity accounts for, m/s."""
    rate = np.diff(run.channel(*POSITION), axis=0) / np.diff(run.time)[:, None]
    velocity = run.channel(*VELOCITY)
    excess = np.linalg.norm(rate - 0.5 * (velocity[1:] + velocity[:-1]), axis=1)
    excess[np.diff(run.stretch) != 0] = 0.0
    return np.concatenate([[0.0], excess])


def _onset(time: np.ndarray, alarm: np.ndarray) -> int | None:
    """Return the first alarm of the last series of alarms if no `_RECOVERY` s are left after it, else None."""
    rows = np.flatnonzero(alarm)
    if not len(rows) or time[-1] - time[rows[-1]] >= _RECOVERY:
        return None
    breaks = np.flatnonzero(np.diff(time[rows]) >= _RECOVERY)
    return int(rows[breaks[-1] + 1] if len(breaks) else rows[0])
