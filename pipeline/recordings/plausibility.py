"""Units and frames that contradict each other: a rate against the derivative of what it is the rate of."""

from collections.abc import Iterator

import numpy as np
import pandas as pd

_DEGREE = 180 / np.pi
_TOLERANCE = 0.25  # of the ratio of two rates that should be equal
_CORRELATION = 0.7  # below, the two have too little in common to say anything
_TWO_TURNS = 4 * np.pi


def implausible_units(frame: pd.DataFrame, kind: str, units: dict[str, str]) -> Iterator[str]:
    """Yield a sentence for each channel that seems to be in another unit or frame than the contract's."""
    for rate, derivative, angle in _pairs(frame, kind):
        yield from _compare(rate, frame[rate].to_numpy(), derivative, angle)
    if kind == "quadrotor":
        yield from _quadrotor(frame)
    angles = [column for column in units if units[column] == "rad"]
    for column in angles:
        if _swings_wide(frame, column):
            yield f"Channel {column!r} swings over more than two turns: degrees where radians belong?"
    if "battery_voltage" in frame and frame["battery_voltage"].median() > 1000:
        yield "Channel 'battery_voltage' is above 1000 V: millivolts where volts belong?"


def _pairs(frame: pd.DataFrame, kind: str) -> Iterator[tuple[str, np.ndarray, str]]:
    """Yield each rate with the derivative that it should equal and the name of what is differentiated."""
    if kind == "joint":
        yield "velocity", _derivative(frame, "position"), "position"
    elif kind == "swerve":
        for module in "1234":
            yield (
                f"steer_velocity_{module}",
                _derivative(frame, f"steer_angle_{module}"),
                f"steer_angle_{module}",
            )
    else:
        for axis in "xyz":
            yield f"velocity_{axis}", _derivative(frame, f"position_{axis}"), f"position_{axis}"
        rates = _body_rates(frame)
        for index, axis in enumerate("xyz"):
            yield f"body_rate_{axis}", rates[:, index], "attitude"


def _derivative(frame: pd.DataFrame, column: str) -> np.ndarray:
    """Central difference over time within each run; NaN at its ends."""
    grouped = frame.groupby("run", sort=False)
    span = grouped["t"].shift(-1) - grouped["t"].shift(1)
    rise = grouped[column].shift(-1) - grouped[column].shift(1)
    return (rise / span).to_numpy()


def _body_rates(frame: pd.DataFrame) -> np.ndarray:
    """Body rate from the attitude, 2·vec(q* ⊗ dq/dt), rad/s, shape (samples, 3)."""
    columns = [f"attitude_{axis}" for axis in "wxyz"]
    w, x, y, z = (frame[column].to_numpy() for column in columns)
    # where the sign flips between two samples (q and −q are one rotation) the derivative is meaningless
    grouped = frame.groupby("run", sort=False)[columns]
    ahead, behind = grouped.shift(-1).to_numpy(), grouped.shift(1).to_numpy()
    dw, dx, dy, dz = (_derivative(frame, column) for column in columns)
    rates = 2 * np.stack(
        [
            w * dx - x * dw - y * dz + z * dy,
            w * dy - y * dw - z * dx + x * dz,
            w * dz - z * dw - x * dy + y * dx,
        ],
        axis=1,
    )
    rates[(ahead * behind).sum(axis=1) < 0.5] = np.nan
    return rates


def _compare(rate: str, measured: np.ndarray, derivative: np.ndarray, angle: str) -> Iterator[str]:
    known = np.isfinite(measured) & np.isfinite(derivative)
    measured, derivative = measured[known], derivative[known]
    if len(measured) < 20 or measured.std() == 0 or derivative.std() == 0:
        return
    # corrupted samples must not decide: leave out the extreme hundredth of either
    usual = (np.abs(measured) <= np.quantile(np.abs(measured), 0.99)) & (
        np.abs(derivative) <= np.quantile(np.abs(derivative), 0.99)
    )
    measured, derivative = measured[usual], derivative[usual]
    if measured.std() == 0 or derivative.std() == 0:
        return
    correlation = float(np.corrcoef(measured, derivative)[0, 1])
    if abs(correlation) < _CORRELATION:
        return
    ratio = float(np.copysign(measured.std() / derivative.std(), correlation))
    if ratio < 0:
        yield f"Channel {rate!r} runs against the change of {angle!r}: another sign or frame?"
    reason = _factor(abs(ratio))
    if reason:
        yield f"Channel {rate!r} is {abs(ratio):.3g} times the rate of change of {angle!r}: {reason}"


def _factor(ratio: float) -> str:
    reasons = {
        _DEGREE: "degrees where radians belong?",
        1 / _DEGREE: "is the angle in degrees where radians belong?",
        1000.0: "millimetres where metres belong?",
        1 / 1000.0: "is the position in millimetres where metres belong?",
        30 / np.pi: "turns per minute where rad/s belong?",
    }
    for factor, reason in reasons.items():
        if abs(ratio / factor - 1) < _TOLERANCE:
            return reason
    return "units do not agree." if not 0.4 < ratio < 2.5 else ""


def _quadrotor(frame: pd.DataFrame) -> Iterator[str]:
    if "specific_force_z" in frame:
        force = float(frame["specific_force_z"].median())
        if force < 0:
            yield "Channel 'specific_force_z' is negative in the median: z down where z up belongs?"
        if 0.5 < abs(force) < 2.0:
            yield "Channel 'specific_force_z' is about 1 in the median: g where m/s² belong?"
    for column in (f"motor_command_{rotor}" for rotor in "1234"):
        if column in frame and float(frame[column].quantile(0.9)) > 1.2:
            yield f"Channel {column!r} exceeds 1: a command of 0 to 1 is expected."
    rates = np.abs(frame[[f"body_rate_{axis}" for axis in "xyz"]].to_numpy())
    for axis in "xyz":
        column = f"body_rate_command_{axis}"
        if column in frame and float(frame[column].abs().quantile(0.99)) > 20 * float(
            np.nanquantile(rates, 0.99)
        ):
            yield f"Channel {column!r} is far larger than the body rate: degrees where radians belong?"


def _swings_wide(frame: pd.DataFrame, column: str) -> bool:
    """Whether an angle goes back and forth, not on and on, over more than two turns."""
    for _, values in frame.groupby("run", sort=False)[column]:
        known = values.dropna().to_numpy()
        if len(known) < 20:
            continue
        span = float(known.max() - known.min())
        path = float(np.abs(np.diff(known)).sum())
        if _TWO_TURNS < span <= 720 and float(np.abs(known).max()) <= 720 and path > 2.5 * span:
            return True
    return False
