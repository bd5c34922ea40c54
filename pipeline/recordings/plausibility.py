"""Plausibility of units and frames: each rate is compared with the derivative of its angle or position."""

from collections.abc import Iterator

import numpy as np
import pandas as pd

from simgap.recordings.contradiction import Contradiction
from simgap.recordings.rates import body_rate_and_derived, recorded_and_derived

_DEGREE = 180 / np.pi
_RATIO_TOLERANCE = 0.35  # of the ratio of two rates; noise and lag take up to a third of it
_CORRELATION = 0.7  # below, the two have too little in common to say anything
_TWO_TURNS = 4 * np.pi
_FEWEST_SAMPLES = 20
_SWERVE = [(f"steer_velocity_{module}", f"steer_angle_{module}") for module in "1234"]
_QUADROTOR = [(f"velocity_{axis}", f"position_{axis}") for axis in "xyz"]
_PAIRS = {"joint": [("velocity", "position")], "swerve": _SWERVE, "quadrotor": _QUADROTOR}
_REMEDY = "Convert it, or declare its unit in the Parquet file."
_RATES = {_DEGREE: "degrees", 1000.0: "millimetres", 30 / np.pi: "turns_per_minute"}  # by how often too large
_ANGLES = {1 / _DEGREE: "degrees", 1 / 1000.0: "millimetres"}  # by how small they make their rate look


def implausible_units(frame: pd.DataFrame, kind: str, units: dict[str, str]) -> Iterator[str]:
    """Yield a sentence for each channel that seems to be in another unit or frame than the contract's."""
    yield from (contradiction.sentence for contradiction in contradicting_rates(frame, kind))
    if kind == "quadrotor":
        yield from _quadrotor(frame)
    for column in units:
        if units[column] == "rad" and _swings_wide(frame, column):
            yield f"Channel {column!r} swings over more than two turns: is it in degrees? {_REMEDY}"
    if "battery_voltage" in frame and frame["battery_voltage"].median() > 1000:
        yield f"Channel 'battery_voltage' is above 1000 V: is it in millivolts? {_REMEDY}"
    for column in units:
        if units[column] == "V" and column != "battery_voltage" and frame[column].abs().quantile(0.99) > 1000:
            yield f"Channel {column!r} exceeds 1000 V: is it in millivolts? {_REMEDY}"


def contradicting_rates(frame: pd.DataFrame, kind: str) -> Iterator[Contradiction]:
    """Yield a contradiction for each rate that is not that of its angle or position."""
    for rate, angle in (pair for pair in _PAIRS[kind] if set(pair) <= {*frame.columns}):
        yield from _compare(rate, angle, *recorded_and_derived(frame, rate, angle))
    if kind == "quadrotor" and "attitude_w" in frame:
        for axis in "xyz":
            yield from _compare(f"body_rate_{axis}", "attitude", *body_rate_and_derived(frame, axis))


def contradicting_position(frame: pd.DataFrame) -> Iterator[Contradiction]:
    """Yield a contradiction where a servo does not go where it is told: of sign, or of unit.

    Each run counts from its own mean: a zero that differs is a load on the servo.
    """
    both = frame[["run", "position_command", "position"]].dropna()
    if len(both) < _FEWEST_SAMPLES:
        return
    apart = both.groupby("run", sort=False)[["position_command", "position"]].transform(
        lambda s: s - s.mean()
    )
    told, gone = (apart[column].to_numpy(dtype=float) for column in apart)
    if np.ptp(told) == 0 or np.ptp(gone) == 0:
        return
    correlation, ratio = float(np.corrcoef(told, gone)[0, 1]), float(told.std() / gone.std())
    if correlation < -_CORRELATION:
        evidence = f"The position runs against its command (correlation {correlation:.2f})"
        yield Contradiction("position_command", "sign", evidence, "Negate 'position_command', or 'position'.")
    evidence = f"The position command moves {ratio:.3g} times as far as the position"
    for column, factor in (("position_command", _DEGREE), ("position", 1 / _DEGREE)):
        if abs(correlation) > _CORRELATION and abs(ratio / factor - 1) < _RATIO_TOLERANCE:
            remedy = f"Convert {column!r}, or declare its unit in the Parquet file."
            yield Contradiction(column, "degrees", evidence, remedy)


def _compare(rate: str, angle: str, recorded: np.ndarray, derived: np.ndarray) -> Iterator[Contradiction]:
    if len(recorded) < _FEWEST_SAMPLES:
        return
    # corrupted samples must not decide: leave out the extreme hundredth of either
    usual = (np.abs(recorded) <= np.quantile(np.abs(recorded), 0.99)) & (
        np.abs(derived) <= np.quantile(np.abs(derived), 0.99)
    )
    recorded, derived = recorded[usual], derived[usual]
    if np.ptp(recorded) == 0 or np.ptp(derived) == 0:
        return
    correlation = float(np.corrcoef(recorded, derived)[0, 1])
    if abs(correlation) < _CORRELATION:
        return
    if correlation < 0:
        evidence = (
            f"Channel {rate!r} runs against the rate of change of {angle!r} (correlation {correlation:.2f})"
        )
        yield Contradiction(rate, "sign", evidence, f"Negate {rate!r}, or {angle!r}.")
    ratio = float(recorded.std() / derived.std())
    evidence = f"Channel {rate!r} is {ratio:.3g} times the rate of change of {angle!r}"
    for column, factors in ((rate, _RATES), (angle, _ANGLES)):
        for factor, suspected in factors.items():
            if abs(ratio / factor - 1) < _RATIO_TOLERANCE:
                remedy = f"Convert {column!r}, or declare its unit in the Parquet file."
                yield Contradiction(column, suspected, evidence, remedy)
                return
    if not 0.4 < ratio < 2.5:
        yield Contradiction(
            rate, "unit", evidence, f"Convert {rate!r} or {angle!r}: their units do not agree."
        )


def _quadrotor(frame: pd.DataFrame) -> Iterator[str]:
    if "specific_force_z" in frame:
        force = float(frame["specific_force_z"].median())
        if force < 0:
            yield "Channel 'specific_force_z' has a negative median: does its z axis point down? It must point up."
        if 0.5 < abs(force) < 2.0:
            yield f"Channel 'specific_force_z' has a median of about 1: is it in g instead of m/s²? {_REMEDY}"
    for column in (f"motor_command_{rotor}" for rotor in "1234"):
        if column in frame and float(frame[column].quantile(0.9)) > 1.2:
            yield f"Channel {column!r} exceeds 1: commands must be 0 to 1."
    fastest = float(np.nanquantile(frame[[f"body_rate_{axis}" for axis in "xyz"]].abs(), 0.99))
    for column in (f"body_rate_command_{axis}" for axis in "xyz"):
        if column in frame and float(frame[column].abs().quantile(0.99)) > 20 * fastest:
            yield f"Channel {column!r} is far larger than the body rate: is it in degrees? {_REMEDY}"


def _swings_wide(frame: pd.DataFrame, column: str) -> bool:
    """Whether an angle goes back and forth, not on and on, over more than two turns."""
    for _, values in frame.groupby("run", sort=False)[column]:
        known = values.dropna().to_numpy()
        if len(known) < _FEWEST_SAMPLES:
            continue
        span = float(np.ptp(known))
        path = float(np.abs(np.diff(known)).sum())
        # what turns on and on ends far from where it began; a circle of degrees, twice over, bounds a joint's
        if _TWO_TURNS < span <= 720 and float(np.abs(known).max()) <= 720 and path > 2.5 * span:
            return True
    return False
