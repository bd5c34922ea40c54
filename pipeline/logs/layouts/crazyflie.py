"""Columns of the logs of a Crazyflie. Its frames are the contract's: forward, left, up, and z up in the world.

Names and units: the reference of log variables at bitcraze.io/documentation/repository/crazyflie-firmware.
"""

import numpy as np

from simgap.logs.layouts.choices import Choice, choose, moves
from simgap.logs.layouts.flights import flights, height_of, stretches
from simgap.logs.layouts.rates import rated, told
from simgap.logs.log import Log, Span
from simgap.logs.proposal import Proposal, Proposed, lacking
from simgap.recordings.contract import TOGETHER

_FULL = 65535  # of a 16-bit command
_PULSE = (
    "the power that the motors were given, 0 to 65535, taken as their speed; where the firmware means a thrust, whose "
    "square root the speed is, add root: true"
)
_HOW = "set the frequency in config.txt on the SD card to 100 Hz or more"
_ADVICE = {
    "position": "stateEstimate.x, stateEstimate.y, stateEstimate.z",
    "velocity": "stateEstimate.vx, stateEstimate.vy, stateEstimate.vz",
    "attitude": "stateEstimate.qx, stateEstimate.qy, stateEstimate.qz, stateEstimate.qw",
    "body_rate": "gyro.x, gyro.y, gyro.z",
    "motor_speed": "motor.m1, motor.m2, motor.m3, motor.m4",
    "motor_command": "motor.m1, motor.m2, motor.m3, motor.m4",
}


def propose(log: Log, kind: str | None = None) -> Proposal | None:
    """Propose the columns of a log of a Crazyflie; None for other logs.

    Args:
        log: as it was read.
        kind: of the platform; another than a quadrotor is refused.
    """
    if log.format != "Crazyflie":
        return None
    if kind not in (None, "quadrotor"):
        return Proposal(kind, {}, refusal=f"is a log of a Crazyflie, not of a {kind}")
    columns: dict[str, Proposed] = {}
    for names, choices in _CHOICES:
        chosen = choose(log, choices)
        if chosen is not None:
            columns |= chosen.columns(names)
    motors = [entry.source.signal for name, entry in columns.items() if name.startswith("motor")]
    windows = _flights(log, motors)
    fast = rated(log, columns, _HOW)
    missing = dict(fast.missing)
    state = [name for name in TOGETHER["quadrotor"] if name not in fast.columns]
    for name in [*lacking("quadrotor", set(fast.columns)), *state]:
        missing.setdefault(name, f"add to config.txt on the SD card: {_ADVICE[name.rpartition('_')[0]]}")
    refusal = _refusal(log, motors, windows) or (
        f"is logged too slowly to show physics: {told(fast.refused)}; {_HOW}" if fast.refused else ""
    )
    return Proposal("quadrotor", fast.columns, missing, windows, fast.notes, refusal)


def _refusal(log: Log, motors: list[str], windows: tuple[Span, ...]) -> str:
    if motors and not moves(log, motors):
        return "its motors never change; record a flight"
    return "" if not motors or windows else "its motors never turn for two seconds; record a flight"


def _names(name: str, axes: str) -> list[str]:
    return [f"{name}_{axis}" for axis in axes]


def _vector(names: str, reason: str, unit: str | None, scale: float = 1.0, confidence: float = 1.0) -> Choice:
    signals = names.split()
    return Choice(signals, reason, unit=unit, scales=[scale] * len(signals), confidence=confidence)


_CHOICES = (
    (
        _names("position", "xyz"),
        (
            _vector(
                "stateEstimate.x stateEstimate.y stateEstimate.z", "the estimate of the firmware, m", "m"
            ),
            _vector(
                "stateEstimateZ.x stateEstimateZ.y stateEstimateZ.z", "the estimate, compressed, mm", "mm"
            ),
            _vector("kalman.stateX kalman.stateY kalman.stateZ", "the Kalman filter, m", "m"),
        ),
    ),
    (
        _names("velocity", "xyz"),
        (
            _vector("stateEstimate.vx stateEstimate.vy stateEstimate.vz", "the estimate, m/s", "m/s"),
            _vector("stateEstimateZ.vx stateEstimateZ.vy stateEstimateZ.vz", "the estimate, mm/s", "mm/s"),
        ),
    ),
    (
        _names("attitude", "wxyz"),
        (
            _vector(" ".join(f"stateEstimate.q{axis}" for axis in "wxyz"), "the estimate's quaternion", "1"),
            _vector(
                " ".join(f"stateEstimateZ.quat/{axis}" for axis in "wxyz"), "the quaternion, unpacked", "1"
            ),
            _vector("kalman.q0 kalman.q1 kalman.q2 kalman.q3", "the Kalman filter's quaternion", "1"),
        ),
    ),
    (
        _names("body_rate", "xyz"),
        (
            _vector("gyro.x gyro.y gyro.z", "the gyroscope, deg/s", "deg/s"),
            _vector(
                "stateEstimateZ.rateRoll stateEstimateZ.ratePitch stateEstimateZ.rateYaw",
                "the gyroscope, compressed, mrad/s",
                "rad/s",
                1e-3,
            ),
        ),
    ),
    (_names("specific_force", "xyz"), (_vector("acc.x acc.y acc.z", "the accelerometer, in g", "g"),)),
    (
        _names("motor_speed", "1234"),
        (_vector("rpm.m1 rpm.m2 rpm.m3 rpm.m4", "measured by the rpm deck", "rpm"),),
    ),
    (
        _names("motor_command", "1234"),
        (_vector("motor.m1 motor.m2 motor.m3 motor.m4", _PULSE, "1", 1 / _FULL, confidence=0.8),),
    ),
    (
        ["battery_voltage"],
        (_vector("pm.vbat", "the battery, V", "V"), _vector("pm.vbatMV", "the battery, mV", "mV")),
    ),
)
"""Columns, and the variables that may be them, the better ones first."""


def _flights(log: Log, motors: list[str]) -> tuple[Span, ...]:
    """Return when the motors turn, clear of the ground where the height is known."""
    if not motors:
        return ()
    signals = [log.signals[name] for name in motors]
    time = signals[0].time
    turning = np.any([signal.values > 0 for signal in signals if len(signal.values) == len(time)], axis=0)
    height = height_of(log, [("stateEstimate.z", 1.0), ("stateEstimateZ.z", 1e-3), ("kalman.stateZ", 1.0)])
    return flights(stretches(time, turning, float(time[-1])), height)
