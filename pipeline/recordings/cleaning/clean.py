"""Clean a recording step by step and report every change."""

import dataclasses
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from simgap.errors import InputError
from simgap.recordings.cleaning.channels import INPUTS
from simgap.recordings.cleaning.clock import estimate_clock_offset
from simgap.recordings.cleaning.coverage import coverage
from simgap.recordings.cleaning.crash import cut_crash
from simgap.recordings.cleaning.dead import erase_dead
from simgap.recordings.cleaning.derived import derived_remark, with_derived
from simgap.recordings.cleaning.filtered import replace_averaged
from simgap.recordings.cleaning.frozen import erase_frozen
from simgap.recordings.cleaning.halved import mend_halved
from simgap.recordings.cleaning.idle import drop_idle
from simgap.recordings.cleaning.limits import erase_beyond_limits
from simgap.recordings.cleaning.missing import erase_sparse_groups, lacking, needed_groups
from simgap.recordings.cleaning.quaternions import mend_quaternions
from simgap.recordings.cleaning.resample import resample, split_at_gaps, typical_step
from simgap.recordings.cleaning.segments import drop_incomplete, drop_made_up, drop_short, segment_numbers
from simgap.recordings.cleaning.settings import Cleaning
from simgap.recordings.cleaning.spikes import erase_spikes
from simgap.recordings.cleaning.straight import erase_straight
from simgap.recordings.cleaning.table import ChannelTable
from simgap.recordings.cleaning.work import WHERE, RunUnderCleaning, changes_table
from simgap.recordings.cleaning.wraps import mend_wraps
from simgap.recordings.contract import required_channels
from simgap.recordings.recording import Recording
from simgap.recordings.runs import by_run, column_of_runs
from simgap.recordings.split import Split, split_recording


@dataclass(frozen=True)
class Cleaned:
    """A cleaned recording with the report of its cleaning.

    Attributes:
        recording: uniform in time inside each (run, segment), complete in every needed channel, split by
            runs.
        changes: one row per change, columns `CHANGE_COLUMNS`.
        coverage: what became of every moment, columns `COVERAGE_COLUMNS`.
    """

    recording: Recording
    changes: pd.DataFrame
    coverage: pd.DataFrame


def clean_recording(
    recording: Recording, settings: Cleaning | None = None, split: Split | None = None, seed: int = 0
) -> tuple[Recording, pd.DataFrame]:
    """Clean a recording; see `clean_with_coverage`, of which this is all but the coverage."""
    cleaned = clean_with_coverage(recording, settings, split, seed)
    return cleaned.recording, cleaned.changes


def clean_with_coverage(
    recording: Recording, settings: Cleaning | None = None, split: Split | None = None, seed: int = 0
) -> Cleaned:
    """Resample, fill, cut and split a recording, and account for every sample.

    Values are first made missing where they cannot be true (beyond limits, straight lines, held messages,
    spikes), then all that is missing is filled or cut out in one place; crashes, idle and short stretches are
    cut from the result. A recording that is clean already is only split.

    Args:
        recording: as read.
        settings: the limits.
        split: how the runs are divided.
        seed: for the draw where fractions divide them.

    Raises:
        InputError: when nothing usable is left, or a limit makes no sense.
    """
    settings = settings or Cleaning()
    settings.check()
    split = split or Split()
    if recording.cleaned:
        parts = split_recording(recording.frame, recording.kind, split, seed)
        runs = [_take_up(recording, name, rows) for name, rows in by_run(recording.frame)]
        split_up = dataclasses.replace(recording, split=parts)
        return Cleaned(_completed(split_up, recording.time_step), changes_table([]), coverage(runs))
    runs = [_take_up(recording, name, rows) for name, rows in by_run(recording.frame)]
    steps = [run.time_step for run in runs if run.is_usable]
    time_step = settings.time_step or (float(np.median(steps)) if steps else 0.0)
    # One after the other, so that no run is held twice but the one at hand.
    for place, run in enumerate(runs):
        if run.is_usable:
            runs[place] = _clean_run(run, time_step, settings)
    changes = changes_table([change for run in runs for change in run.changes])
    usable = [run for run in runs if run.is_usable]
    if not usable:
        raise InputError(_why_nothing(changes), recording.source or "recording", "give another recording")
    frame = _frame(usable, recording)
    result = dataclasses.replace(
        recording,
        frame=frame,
        split=split_recording(frame, recording.kind, split, seed),
        clock_offset={run.name: run.clock_offset for run in usable if run.clock_offset is not None},
        noise_kept={run.name: run.noise_kept for run in usable if run.noise_kept < 1.0},
        warnings=(*recording.warnings, *_remarks(runs)),
        cleaned=True,
    )
    return Cleaned(_completed(result, time_step), changes, coverage(runs))


def _remarks(runs: Sequence[RunUnderCleaning]) -> list[str]:
    """Return the remarks on all runs; what is said of several is said once."""
    names: dict[str, list[str]] = {}
    for run in runs:
        for remark in run.remarks:
            names.setdefault(remark, []).append(run.name)

    def where(of: list[str]) -> str:
        return f"run {of[0]!r}" if len(of) == 1 else f"{len(of)} of {len(runs)} runs"

    return [remark.replace(WHERE, where(of)) for remark, of in names.items()]


def _completed(recording: Recording, time_step: float) -> Recording:
    """Return a recording with the channels that another one shows, if it lacks them."""
    frame, units, derived = with_derived(recording.frame, recording.kind, recording.units, time_step)
    if not derived:
        return recording
    remark = derived_remark(derived, recording.kind)
    warnings = (*recording.warnings, remark)
    return dataclasses.replace(recording, frame=frame, units=units, derived=derived, warnings=warnings)


def _take_up(recording: Recording, name: str, rows: pd.DataFrame) -> RunUnderCleaning:
    """Begin with one run; an unusable run is dropped as a whole."""
    groups = needed_groups(rows, recording.kind)
    reason = lacking(rows, recording.kind, groups)
    lost: dict[str, int] = {}
    if not reason:
        rows, lost = erase_sparse_groups(rows, recording.kind, groups)
    time = rows["t"].to_numpy(dtype="float64")
    run = RunUnderCleaning(
        name=name,
        kind=recording.kind,
        time=time,
        columns=recording.channels,
        table=ChannelTable.of(rows, recording.channels),
        stretch=rows["segment"].to_numpy(copy=True)
        if "segment" in rows
        else np.zeros(len(time), dtype=np.int32),
        needed=[
            *required_channels(recording.kind, recording.channels),
            *(groups if not reason else []),
        ],
        time_step=typical_step(time) if len(time) > 1 else 0.0,
    )
    if "filled" in rows:
        run.filled = rows["filled"].to_numpy() > 0
    for column, samples in lost.items():
        run.note("missing", column, "missing in most of the run, left out", samples)
    if reason:
        run.drop(np.ones(len(time), dtype=bool), "missing", reason)
    return run


def _clean_run(run: RunUnderCleaning, time_step: float, settings: Cleaning) -> RunUnderCleaning:
    gap = max(settings.max_gap, 1.5 * time_step)
    split_at_gaps(run, gap)
    mend_rows(run)
    mend_quaternions(run)
    erase_beyond_limits(run)
    erase_straight(run, gap)
    if settings.frozen:
        erase_frozen(run, gap)
    if settings.spikes:
        erase_spikes(run)
    run = resample(run, time_step, settings)
    drop_incomplete(run)
    if run.is_usable:
        _cut(run, settings)
    return run


def mend_rows(run: RunUnderCleaning) -> None:
    """Undo what can be undone, and erase what stands still, before anything else can hide it."""
    mend_wraps(run)
    mend_halved(run)
    erase_dead(run)
    replace_averaged(run)


def mended(recording: Recording) -> Recording:
    """Return a recording with wraps undone and dead stretches erased; nothing else is changed."""
    runs = [_take_up(recording, name, rows) for name, rows in by_run(recording.frame)]
    for run in runs:
        if len(run.time) > 2:
            mend_rows(run)
    values = np.concatenate([run.values for run in runs])
    frame = recording.frame.copy()
    order = np.argsort(pd.factorize(frame["run"])[0], kind="stable")
    frame.loc[frame.index[order], recording.channels] = values
    return dataclasses.replace(recording, frame=frame)


def _cut(run: RunUnderCleaning, settings: Cleaning) -> None:
    """Drop unusable parts, then estimate the clock offset of the rest."""
    if settings.crash:
        cut_crash(run, settings.crash_margin)
    if settings.idle:
        drop_idle(run, settings.min_idle)
    drop_short(run, settings.min_duration)
    drop_made_up(run, settings.min_measured)
    run.clock_offset = estimate_clock_offset(run, settings.max_clock_offset)


def _frame(runs: list[RunUnderCleaning], recording: Recording) -> pd.DataFrame:
    kept = [_kept(run) for run in runs]

    def joined(column: Callable[[RunUnderCleaning], np.ndarray]) -> np.ndarray:
        parts = [column(run)[rows] for run, rows in zip(runs, kept, strict=True)]
        return parts[0] if len(parts) == 1 else np.concatenate(parts)

    lengths = [int(np.count_nonzero(run.dropped == 0)) for run in runs]
    columns: dict[str, object] = {
        "run": column_of_runs([run.name for run in runs], lengths, recording.frame["run"]),
        "t": _shared(joined(lambda run: run.time), recording.frame["t"]),
        "segment": joined(segment_numbers),
    }
    if INPUTS[recording.kind]:
        columns["filled"] = joined(lambda run: run.filled.astype(np.int64))
    for place, channel in enumerate(recording.channels):
        columns[channel] = (
            runs[0].table.kept(place, kept[0])
            if len(runs) == 1
            else joined(lambda run, place=place: run.table.arrays[place])  # type: ignore[misc]
        )
    return pd.DataFrame(columns, copy=False)


def _shared(times: np.ndarray, like: pd.Series) -> pd.Series | np.ndarray:
    """Return times as the column of the recording, if they are the same; else a copy of them."""
    return like.reset_index(drop=True) if np.array_equal(times, like) else times.copy()


def _kept(run: RunUnderCleaning) -> slice | np.ndarray:
    """Return the samples that are kept; as a slice, which takes no copy, where they are neighbours."""
    rows = np.flatnonzero(run.dropped == 0)
    first, past = int(rows[0]), int(rows[-1]) + 1
    return slice(first, past) if past - first == len(rows) else rows


def _why_nothing(changes: pd.DataFrame) -> str:
    dropped = changes[(changes["column"] == "") & (changes["samples"] < 0)]
    reasons = dropped.groupby("reason")["samples"].sum().sort_values()
    told = "; ".join(f"{reason} ({-count} samples)" for reason, count in reasons.items())
    return f"nothing usable is left after cleaning: {told}"
