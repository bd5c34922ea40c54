"""Offset between the clocks of state and motor telemetry, estimated from the physics."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.fft import irfft, next_fast_len, rfft, rfftfreq
from scipy.optimize import minimize_scalar
from scipy.signal import butter, sosfiltfilt

from simgap.recordings.cleaning.channels import (
    BODY_RATE,
    MOTOR_COMMAND,
    MOTOR_SPEED,
    SPECIFIC_FORCE,
)
from simgap.recordings.cleaning.segments import unbroken
from simgap.recordings.cleaning.work import RunUnderCleaning

_BAND = (1.0, 20.0)  # Hz; below lies drag and sag, above noise
_EDGE = 0.2  # s at either end of a stretch in which the filters ring
_SHORTEST_FLIGHT = 5.0  # s of flight
_SOUND = 0.4  # explained share of variance from which on the estimate is believed; at a third, coincidences were seen
_LARGEST_ERROR = 0.5  # of a time step: a larger standard error is no estimate
_MOST = 50_000  # samples that are compared; none of the published recordings gains by more
_BLOCK = 1.0  # s; residuals farther apart than this are taken as independent


@dataclass
class ClockOffset:
    """An estimate of the delay of measurements.

    Attributes:
        seconds: positive where the measurements are late with respect to the motors.
        error: standard error, s.
        explained: share of the measurements' variance in the band that the motors explain at that offset.
        at_bound: whether the best offset is the largest that was tried.
    """

    seconds: float
    error: float
    explained: float
    at_bound: bool

    def is_sound(self, time_step: float) -> bool:
        """Return whether the estimate is reliable."""
        return not self.at_bound and self.explained >= _SOUND and self.error <= _LARGEST_ERROR * time_step


def estimate_clock_offset(run: RunUnderCleaning, largest: float) -> float | None:
    """Estimate the clock offset of a flight and report it; return the state's offset, s, if it is reliable.

    The squared rotor speeds explain the angular acceleration about roll and pitch, which shows the clock of
    the state (gyroscope), and the specific force along z, which shows that of the accelerometer where it has
    its own. With commands alone, the lag of the motors cannot be told from an offset: it is written down and
    not returned.
    """
    if run.kind != "quadrotor":
        return None
    inputs = next((group for group in (MOTOR_SPEED, MOTOR_COMMAND) if set(group) <= set(run.needed)), None)
    if inputs is None:
        return None
    filtered: dict[int, np.ndarray] = {}
    offsets = {"body_rate": _offset(run, inputs, BODY_RATE[:2], True, largest, filtered)}
    if run.has(SPECIFIC_FORCE):
        offsets["specific_force_z"] = _offset(run, inputs, SPECIFIC_FORCE[2:], False, largest, filtered)
    for column, offset in offsets.items():
        if offset is not None:
            _note(run, inputs, column, offset)
    if inputs is MOTOR_COMMAND:
        return None
    sound = [offset for offset in offsets.values() if offset is not None and offset.is_sound(run.time_step)]
    return sound[0].seconds if sound else None


def _note(run: RunUnderCleaning, inputs: list[str], column: str, offset: ClockOffset) -> None:
    if not offset.is_sound(run.time_step):
        reason = "clock offset could not be estimated"
    elif inputs is MOTOR_COMMAND:
        reason = "late with respect to the motor commands (lag of the motors included), not applied"
    else:
        reason = "late with respect to the motor speeds, not applied"
    detail = f"{offset.seconds:.5f} ± {offset.error:.5f} s, explains {offset.explained:.0%}"
    run.note("clock", column, reason, 0, detail, seconds=offset.seconds)


def _offset(
    run: RunUnderCleaning,
    inputs: list[str],
    outputs: list[str],
    differentiate: bool,
    largest: float,
    filtered: dict[int, np.ndarray],
) -> ClockOffset | None:
    """Gather the stretches of flight and compare; None where there is too little.

    The inputs of whole stretches are kept in `filtered`, by their first samples, for the next outputs.
    """
    band = _filter(run.time_step)
    if band is None:
        return None
    edge = int(np.ceil((_EDGE + largest) / run.time_step))
    pieces = []
    left = _MOST
    for first, past in unbroken(run).tolist():
        past = min(past, first + left)
        measured = run.rows(slice(first, past), outputs)
        if past - first > 4 * edge and np.isfinite(measured).all():
            if differentiate:
                measured = np.gradient(measured, run.time_step, axis=0)
            if len(filtered.get(first, ())) != past - first:
                driving = run.rows(slice(first, past), inputs)
                filtered[first] = sosfiltfilt(band, driving**2, axis=0)
            pieces.append((filtered[first], sosfiltfilt(band, measured, axis=0)))
            left -= past - first
    if sum(len(motors) - 2 * edge for motors, _ in pieces) * run.time_step < _SHORTEST_FLIGHT:
        return None
    return compare_clocks(pieces, run.time_step, largest, edge)


@lru_cache(maxsize=4)
def _filter(time_step: float) -> np.ndarray | None:
    """Return the filter of the band, as sections; None where the samples are too far apart for it."""
    nyquist = 0.5 / time_step
    if _BAND[0] >= 0.5 * nyquist:
        return None
    return np.asarray(
        butter(2, [_BAND[0], min(_BAND[1], 0.8 * nyquist)], "band", fs=2 * nyquist, output="sos")
    )


def compare_clocks(
    pieces: list[tuple[np.ndarray, np.ndarray]], time_step: float, largest: float, edge: int
) -> ClockOffset | None:
    """Estimate the lag of outputs behind the inputs that drive them linearly.

    For each offset the inputs are delayed (exactly, by their Fourier transform) and the outputs regressed on
    them; the best offset leaves the smallest residual. Its standard error follows from the slope of the
    residual there, with residuals correlated within blocks (the sandwich estimator of Liang and Zeger, 1986).

    Args:
        pieces: inputs of shape (samples, inputs) and outputs of shape (samples, outputs), both through one
            filter.
        time_step: s.
        largest: s, the largest offset that is tried.
        edge: samples at either end of a piece that are left out.
    """
    measured = np.concatenate([outputs[edge:-edge] for _, outputs in pieces])
    scale = measured.std(axis=0)
    if not (scale > 0).all() or not all(np.ptp(inputs) > 0 for inputs, _ in pieces):
        return None
    measured = measured / scale
    spectra = [_spectrum(inputs) for inputs, _ in pieces]

    def delayed(offset: float, derivative: bool = False) -> np.ndarray:
        return np.concatenate([_delay(*each, offset / time_step, derivative)[edge:-edge] for each in spectra])

    @lru_cache(maxsize=4)  # the best offset is among the last ones that are tried
    def fitted(offset: float) -> tuple[np.ndarray, np.ndarray]:
        inputs = delayed(offset)
        return inputs, _gains(inputs, measured)

    def loss(offset: float) -> float:
        inputs, gains = fitted(offset)
        return float(((measured - inputs @ gains) ** 2).mean())

    scaled = [(u, y / scale) for u, y in pieces]
    near, at_bound = _nearest_sample(scaled, spectra, int(largest / time_step), edge)
    bounds = ((near - 1) * time_step, (near + 1) * time_step)
    found = minimize_scalar(loss, bounds=bounds, method="bounded", options={"xatol": 1e-3 * time_step})
    offset = float(found.x)
    error = _standard_error(*fitted(offset), delayed(offset, True) / time_step, measured, time_step)
    return ClockOffset(offset, error, 1.0 - float(found.fun), at_bound)


def _nearest_sample(
    pieces: list[tuple[np.ndarray, np.ndarray]],
    spectra: list[tuple[np.ndarray, int]],
    largest: int,
    edge: int,
) -> tuple[int, bool]:
    """Return the best offset in whole samples by cross-correlation, and whether it is the largest tried."""
    lags = np.arange(-largest, largest + 1)
    count, measured = pieces[0][0].shape[1], pieces[0][1].shape[1]
    moments, products = np.zeros((count, count)), np.zeros((len(lags), count, measured))
    for (inputs, outputs), (spectrum, _) in zip(pieces, spectra, strict=True):
        inner = np.zeros_like(outputs)
        inner[edge:-edge] = outputs[edge:-edge]
        length = 2 * (spectrum.shape[1] - 1)
        cross = np.conj(spectrum)[:, None] * rfft(inner.T, n=length)
        products += np.moveaxis(irfft(cross, n=length)[..., lags], -1, 0)  # (lags, inputs, outputs)
        moments += inputs.T @ inputs
    gains = np.linalg.solve(moments + 1e-9 * np.trace(moments) * np.eye(count), products)
    best = int(np.argmax((products * gains).sum(axis=(1, 2))))
    return int(lags[best]), best in (0, len(lags) - 1)


def _spectrum(inputs: np.ndarray) -> tuple[np.ndarray, int]:
    """Return the transforms of the inputs, and their length; they are padded so that the delay does not wrap around.

    Each of them, (inputs, frequencies), is in one piece of memory, which is faster to transform.
    """
    return rfft(inputs.T, n=2 * next_fast_len(len(inputs), real=True)), len(inputs)


def _delay(spectrum: np.ndarray, count: int, samples: float, derivative: bool) -> np.ndarray:
    """Return the inputs delayed by `samples`, (samples, inputs), or their derivative by time in samples."""
    length = 2 * (spectrum.shape[1] - 1)
    frequency = _frequencies(length)
    turn = np.empty(len(frequency), dtype=np.complex128)
    np.cos(-samples * frequency, out=turn.real)
    np.sin(-samples * frequency, out=turn.imag)
    shifted = spectrum * turn
    if derivative:
        shifted *= 1j * frequency
    return irfft(shifted, n=length, overwrite_x=True)[:, :count].T


@lru_cache(maxsize=4)
def _frequencies(length: int) -> np.ndarray:
    """Return the frequencies of a transform, rad per sample, (frequencies,)."""
    return np.asarray(2.0 * np.pi * rfftfreq(length))


def _gains(inputs: np.ndarray, outputs: np.ndarray) -> np.ndarray:
    """Return by how much each input explains each output, (inputs, outputs), by the normal equations.

    They are of a few columns alike in size: many times as fast as a decomposition of all samples, and as exact.
    """
    return np.linalg.lstsq(inputs.T @ inputs, inputs.T @ outputs, rcond=None)[0]


def _standard_error(
    inputs: np.ndarray, gains: np.ndarray, derivative: np.ndarray, outputs: np.ndarray, time_step: float
) -> float:
    residual = outputs - inputs @ gains
    slope = -derivative @ gains  # of the prediction, per second of offset
    slope = slope - inputs @ _gains(inputs, slope)
    score = (slope * residual).sum(axis=1)
    blocks = np.add.reduceat(score, np.arange(0, len(score), max(1, round(_BLOCK / time_step))))
    return float(np.sqrt((blocks**2).sum()) / (slope**2).sum())
