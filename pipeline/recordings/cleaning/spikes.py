"""Spikes: isolated samples that leave and return faster than the signal around them moves."""

from collections.abc import Sequence

import numpy as np
from scipy.ndimage import median_filter

from simgap.recordings.cleaning.channels import (
    ATTITUDE,
    BODY_RATE,
    COMMANDS,
    ESTIMATED_ATTITUDE,
    INPUTS,
    QUATERNIONS,
    SLOW,
    SPECIFIC_FORCE,
)
from simgap.recordings.cleaning.work import RunUnderCleaning

_WIDEST = 3  # samples
_TIMES_STEPS_BESIDE = 4.0  # times the largest step just before and after
# of an excursion, the step into it: the samples on both sides differ by a fraction only
_INTO = 1.0 - 1.0 / _TIMES_STEPS_BESIDE
_NOISE = 10.0  # times the noise of the whole run
_LOCAL = 5.0  # times the roughness around, which rules out bursts
_QUANTA = 6.0
_OF_RANGE = 0.5  # of the range that the channel covers in the run
_OF_SPEED = 3.0  # times as fast as the rate of change that is measured beside the channel
_SHOCK = dict.fromkeys(BODY_RATE, 40.0) | dict.fromkeys(SPECIFIC_FORCE, 200.0)  # rad/s, m/s²; shocks are true
_GROSS = 4.0  # times all of these: impossible even where samples close by are missing
_SAMPLES_AROUND = 15  # samples on either side that make the roughness
_FEWEST_SAMPLES = 2 * _SAMPLES_AROUND  # samples of a channel that can be judged

_RATE_COLUMNS = {"position": ["velocity"]}
_RATE_COLUMNS |= {f"steer_angle_{module}": [f"steer_velocity_{module}"] for module in "1234"}
_RATE_COLUMNS |= {
    f"{name}position_{axis}": [f"{name}velocity_{axis}"] for name in ("", "estimate_") for axis in "xyz"
}
_RATE_COLUMNS |= dict.fromkeys([*ATTITUDE, *ESTIMATED_ATTITUDE], BODY_RATE)
_INTEGRAL = {rates[0]: column for column, rates in _RATE_COLUMNS.items() if len(rates) == 1}


def erase_spikes(run: RunUnderCleaning) -> None:
    """Erase spikes: excursions of one to three samples from a calm course and back.

    A step does not come back, a transient is not calm on either side, a burst is rough around; and a pulse of
    speed that the position confirms is true. Inputs and commands may jump and are left, and so are channels
    that are logged less often than the rest.
    """
    usual: dict[str, float] = {}  # speeds by their channels, until one of them changes
    for column in run.columns:
        if column in COMMANDS | SLOW or column in INPUTS[run.kind]:
            continue
        values = run.column(column)
        if np.count_nonzero(np.isfinite(values)) < _FEWEST_SAMPLES or _stands_still(values):
            continue
        rows = find_spikes(values, run.time, _least(run, column, usual), _integral(run, column))
        if rows.any():
            quaternion = next((columns for columns in QUATERNIONS if column in columns), [column])
            worst = values[rows][np.argmax(np.abs(values[rows]))]
            run.erase(rows, quaternion, "spikes", "isolated implausible sample", f"up to {worst:.4g}")
            usual.clear()


def _stands_still(values: np.ndarray) -> bool:
    """Return whether a channel never leaves its value, so that what is usual of it need not be found out."""
    return bool(np.fmin.reduce(values) == np.fmax.reduce(values))


def _least(run: RunUnderCleaning, column: str, usual: dict[str, float]) -> float:
    """Return the smallest excursion that counts as a spike; usual speeds that it takes are kept in `usual`."""
    if column in _SHOCK:
        return _SHOCK[column]
    rates = [rate for rate in _RATE_COLUMNS.get(column, []) if rate in run.columns]
    if rates:
        name = " ".join(rates)
        if name not in usual:
            usual[name] = _usual_speed([run.column(rate) for rate in rates])
        return _OF_SPEED * usual[name] * run.time_step
    low, high = np.nanquantile(run.column(column), [0.01, 0.99])
    return float(_OF_RANGE * (high - low))


def _usual_speed(rates: Sequence[np.ndarray]) -> float:
    """Return the size that 99 % of the known values do not exceed."""
    speeds = np.abs(np.concatenate(rates))
    known = np.isfinite(speeds)
    speeds = speeds if known.all() else speeds[known]
    return float(np.quantile(speeds, 0.99, overwrite_input=True)) if len(speeds) else np.inf


def _integral(run: RunUnderCleaning, column: str) -> np.ndarray | None:
    integral = _INTEGRAL.get(column, "")
    return run.column(integral) if integral in run.columns else None


def find_spikes(
    values: np.ndarray, time: np.ndarray, least: float = 0.0, integral: np.ndarray | None = None
) -> np.ndarray:
    """Return the mask of spikes, shape (samples,).

    Args:
        values: the channel, shape (samples,); NaN where missing.
        time: s, shape (samples,).
        least: how far an excursion must go.
        integral: the channel of which `values` is the rate of change, to confirm pulses.
    """
    result = np.zeros(len(values), dtype=bool)
    finite = np.isfinite(values)
    present = values if finite.all() else values[finite]
    if len(present) < _FEWEST_SAMPLES:
        return result
    step = np.diff(present)
    np.abs(step, out=step)
    if not step.max() > _INTO * least:
        return result  # whatever its quanta and its noise are, which takes long to find out
    floor = max(_QUANTA * np.where(step > 0, step, np.inf).min(), least)
    widths = range(1, _WIDEST + 1)
    if not any(len(_excursions(present, step, width, floor)) for width in widths):
        return result
    known = np.flatnonzero(finite)
    roughness = np.abs(present - median_filter(present, size=5, mode="nearest"))
    floor = max(_NOISE * 1.4826 * float(np.median(roughness)), floor)
    for width in widths:
        for first in _excursions(present, step, width, floor):
            inside = slice(first, first + width)
            rows = known[inside]
            alone = known[first + width + 1] - known[first - 2] == width + 3  # nothing missing close by
            height = _height(present, inside)
            if (
                (alone or height > _GROSS * floor)
                and not _rough_around(roughness, inside, height)
                and (integral is None or not _confirmed(values, integral, time, rows))
            ):
                result[rows] = True
    return result


def _excursions(values: np.ndarray, step: np.ndarray, width: int, floor: float) -> np.ndarray:
    """Return the starts of excursions of `width` samples that exceed the signal on either side.

    Args:
        values: shape (samples,).
        step: size of the steps between them, shape (samples − 1,).
        width: in samples.
        floor: what an excursion exceeds.
    """
    begins = 2 + np.flatnonzero(step[1 : -width - 1] > _INTO * floor)
    before, after = values[begins - 1], values[begins + width]
    calm = np.maximum(np.abs(before - values[begins - 2]), np.abs(values[begins + width + 1] - after))
    calm = np.maximum(calm, np.abs(after - before))
    offsets = np.arange(width)[:, None]
    share = (offsets + 1) / (width + 1)
    excursion = values[begins + offsets] - (before + share * (after - before))
    least = np.abs(excursion).min(axis=0)
    alike = np.abs(np.sign(excursion).sum(axis=0)) == width
    return begins[alike & (least > _TIMES_STEPS_BESIDE * calm) & (least > floor)]


def _height(values: np.ndarray, inside: slice) -> float:
    base = 0.5 * (values[inside.start - 1] + values[inside.stop])
    return float(np.abs(values[inside] - base).min())


def _rough_around(roughness: np.ndarray, inside: slice, height: float) -> bool:
    around = np.concatenate(
        [
            roughness[max(0, inside.start - _SAMPLES_AROUND) : max(0, inside.start - 2)],
            roughness[inside.stop + 2 : inside.stop + _SAMPLES_AROUND],
        ]
    )
    return height < _LOCAL * float(np.quantile(around, 0.9))


def _confirmed(values: np.ndarray, integral: np.ndarray, time: np.ndarray, rows: np.ndarray) -> bool:
    """Return whether the integral moved by at least half of what the pulse, taken as true, would have moved
    it."""
    first, last = max(0, rows[0] - 1), min(len(values) - 1, rows[-1] + 1)
    base = 0.5 * (values[first] + values[last])
    pulse = float(((values[rows] - base) * np.gradient(time)[rows]).sum())
    moved = float(integral[last] - integral[first] - base * (time[last] - time[first]))
    return bool(np.isfinite(moved) and moved * np.sign(pulse) >= 0.5 * abs(pulse))
