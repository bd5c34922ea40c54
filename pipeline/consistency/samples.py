"""A recording as plain arrays, and averages of it over short windows."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
import pandas as pd

from simgap.recordings.recording import Recording

HALF_WINDOW = 0.05
"""Half of a window, s: long against quantised and held samples, short against a manoeuvre."""

MOST_SAMPLES = 20_000
"""Samples that are looked at; more of the same machine would say the same."""

SEARCHED_SAMPLES = 3_000
"""Samples with which each transformation is tried."""

_GAP_STEPS = 3.0  # usual steps; a window over a longer gap says nothing
_KEPT_SHARE = 0.8  # of the velocity's variance, which averaging over a window must leave
_SHORTEST_HALF = 1


@dataclass(frozen=True)
class Samples:
    """Columns of a recording.

    Attributes:
        kind: quadrotor, swerve or joint.
        run: number of the run of each sample, (samples,).
        columns: `t` (s) and the channels, (samples,) each; NaN where missing.
        half_seconds: half of a window, s.
        known: results that were worked out from some columns, which other samples may share.
    """

    kind: str
    run: np.ndarray
    columns: Mapping[str, np.ndarray]
    half_seconds: float = HALF_WINDOW
    known: dict[str, tuple[list[np.ndarray], Any]] = field(default_factory=dict, repr=False, compare=False)

    def __contains__(self, column: str) -> bool:
        return column in self.columns

    def __getitem__(self, column: str) -> np.ndarray:
        return self.columns[column]

    def having(self, changed: Mapping[str, np.ndarray]) -> "Samples":
        """Return the samples with some columns changed."""
        after = Samples(self.kind, self.run, {**self.columns, **changed}, self.half_seconds, self.known)
        return after if "t" not in changed else with_window(after)

    def once(self, name: str, columns: list[str], work: Callable[["Samples"], Any]) -> Any:
        """Return what follows from some columns; while they stay the same, it is worked out once.

        Args:
            name: of the result.
            columns: that it follows from.
            work: how.
        """
        arrays = [self.columns[column] for column in ("t", *columns)]
        if name in self.known:
            before, result = self.known[name]
            if all(one is other for one, other in zip(arrays, before, strict=True)):
                return result
        result = work(self)
        self.known[name] = (arrays, result)
        return result

    def stack(self, stem: str, suffixes: str) -> np.ndarray:
        """Return the components of a vector, (samples, components)."""
        return np.stack([self.columns[f"{stem}_{suffix}"] for suffix in suffixes], axis=-1)

    def has(self, stem: str, suffixes: str) -> bool:
        """Return whether every component of a vector is there."""
        return all(f"{stem}_{suffix}" in self.columns for suffix in suffixes)

    @cached_property
    def time_step(self) -> float:
        """The usual time between two samples, s; NaN for a single sample."""
        steps = np.diff(self.columns["t"])[np.diff(self.run) == 0]
        return float(np.median(steps)) if len(steps) else np.nan

    @cached_property
    def half(self) -> int:
        """Half of a window in samples."""
        steps = self.half_seconds / self.time_step if self.time_step > 0 else 1.0
        return max(_SHORTEST_HALF, round(min(steps, 1e4)))

    @cached_property
    def centres(self) -> np.ndarray:
        """The samples in the middle of a window, half a window apart, (windows,)."""
        half, time = self.half, self.columns["t"]
        centres = np.arange(half, len(time) - half, half)
        span = time[centres + half] - time[centres - half]
        unbroken = (self.run[centres + half] == self.run[centres - half]) & (span > 0)
        return centres[unbroken & (span < _GAP_STEPS * 2 * half * self.time_step)]

    def ends(self, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the values at the beginning and at the end of each window."""
        return values[self.centres - self.half], values[self.centres + self.half]

    @cached_property
    def span(self) -> np.ndarray:
        """Length of each window, s."""
        before, after = self.ends(self.columns["t"])
        return after - before

    def rate(self, values: np.ndarray) -> np.ndarray:
        """Return the mean rate of change over each window, (windows, ...)."""
        before, after = self.ends(values)
        return (after - before) / self.span.reshape(-1, *[1] * (values.ndim - 1))

    def mean(self, values: np.ndarray) -> np.ndarray:
        """Return the mean over each window by the trapezoid rule, (windows, ...); NaN where a value is missing."""
        half = self.half
        first, past = self.centres - half, self.centres + half + 1
        absent = ~np.isfinite(values).reshape(len(values), -1).all(axis=1)
        if absent.any():
            values = np.where(absent.reshape(-1, *[1] * (values.ndim - 1)), 0.0, values)
        missing = np.cumsum(np.concatenate([[0], absent]))
        whole = np.cumsum(np.concatenate([np.zeros_like(values[:1]), values]), axis=0)
        before, after = self.ends(values)
        total = (whole[past] - whole[first] - 0.5 * (before + after)) / (2 * half)
        total[missing[past] > missing[first]] = np.nan
        return total

    def mean_angle(self, stem: str, suffixes: str) -> np.ndarray:
        """Return the direction of angles averaged over each window, (windows, components) rad; turns do not matter."""
        angles = self.stack(stem, suffixes)
        return np.arctan2(self.mean(np.sin(angles)), self.mean(np.cos(angles)))

    def integral(self, rate: np.ndarray) -> np.ndarray:
        """Return the integral of a rate by the trapezoid rule, from zero in each run, (samples,)."""
        step = np.diff(self.columns["t"]) * 0.5 * (np.nan_to_num(rate[1:]) + np.nan_to_num(rate[:-1]))
        whole = np.concatenate([[0.0], np.cumsum(step)])
        starts = np.flatnonzero(np.diff(self.run, prepend=self.run[0] - 1))
        return whole - np.repeat(whole[starts], np.diff(np.append(starts, len(whole))))

    def noise_of_mean(self, values: np.ndarray) -> float:
        """Return the standard deviation of a window's mean by sensor noise."""
        return noise_of(values) / float(np.sqrt(2 * self.half))

    def noise_of_rate(self, values: np.ndarray) -> float:
        """Return the standard deviation of a window's rate of change by sensor noise."""
        return noise_of(values) * float(np.sqrt(2.0) / (2 * self.half * self.time_step))


def noise_of(values: np.ndarray) -> float:
    """Return the standard deviation of white noise on a smooth series, by the median of its fifth differences.

    Source: Gasser, Sroka & Jennen-Steinmetz 1986. The fifth difference of white noise has 252 times its variance.
    """
    bends = np.abs(np.diff(values, n=5))
    bends = bends[np.isfinite(bends)]
    return float(np.median(bends)) / (0.6745 * np.sqrt(252.0)) if len(bends) else 0.0


def samples_of(recording: Recording, runs: list[str] | None = None) -> Samples:
    """Return the samples of a recording, or of some of its runs; a long recording is thinned out run by run.

    Args:
        recording: raw or cleaned.
        runs: which to take; all of them without.
    """
    frame = recording.frame
    names = frame["run"].astype(str)
    if runs is not None:
        frame = frame[names.isin(runs)]
        names = frame["run"].astype(str)
    keys = names if "segment" not in frame else names + "\n" + frame["segment"].astype(str)
    codes, _ = pd.factorize(keys)
    kept = _thinned(codes)
    columns = {name: frame[name].to_numpy(dtype=float)[kept] for name in ("t", *recording.channels)}
    samples = Samples(recording.kind, codes[kept], columns)
    return with_window(samples)


def thinner(samples: Samples) -> Samples:
    """Return fewer samples, for a search."""
    kept = _thinned(samples.run, SEARCHED_SAMPLES)
    columns = {name: values[kept] for name, values in samples.columns.items()}
    return Samples(samples.kind, samples.run[kept], columns, samples.half_seconds)


def _thinned(codes: np.ndarray, most: int = MOST_SAMPLES) -> np.ndarray:
    """Return the first samples of every run, the same share of each."""
    if len(codes) <= most:
        return np.arange(len(codes))
    share = most / len(codes)
    starts = np.flatnonzero(np.diff(codes, prepend=-1))
    lengths = np.diff(np.append(starts, len(codes)))
    pieces = zip(starts, np.ceil(share * lengths).astype(int), strict=True)
    return np.concatenate([np.arange(start, start + length) for start, length in pieces])


def with_window(samples: Samples) -> Samples:
    """Return samples with short enough windows: a joint may go to and fro many times in a tenth of a second."""
    if samples.kind != "joint":
        return Samples(samples.kind, samples.run, samples.columns)
    motion = samples["velocity" if "velocity" in samples else "position"]
    whole = float(np.nanvar(motion))
    half = HALF_WINDOW
    while half > samples.time_step:
        tried = Samples(samples.kind, samples.run, samples.columns, half)
        if len(tried.centres) < 2 or np.nanvar(tried.mean(motion)) >= _KEPT_SHARE * whole:
            return tried
        half /= 2
    return Samples(samples.kind, samples.run, samples.columns, max(half, samples.time_step))
