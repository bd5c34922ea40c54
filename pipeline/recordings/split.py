"""Division of whole runs into training, validation and hold-out."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fnmatch import fnmatchcase

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from simgap.errors import InputError
from simgap.recordings.holdouts import chosen, first, groups_of, most_alike
from simgap.recordings.opposites import opposite_runs
from simgap.recordings.resemblance import distances_of
from simgap.recordings.runs import by_run

PARTS = ("train", "validation", "holdout")
RESEMBLANCE, CHANCE = "resemblance", "chance"


@dataclass
class Split:
    """How the runs of a dataset are divided.

    Patterns name runs as file names are matched (`melon_*`); a run that no pattern names is trained on.
    Without any pattern the fractions say how much of the recorded time goes where. The two directions of one test stay
    together, and half of the time and of the tests is fitted. Which tests are held out says how much they resemble
    others: a test that is alone in what it does has to be fitted, or nothing can be learned from it.
    """

    validation: list[str] = field(default_factory=list)  # patterns of runs to choose a model by
    holdout: list[str] = field(default_factory=list)  # patterns of runs to prove a result on
    validation_fraction: float = 0.15  # of the seconds, where no pattern is given
    holdout_fraction: float = (
        0.25  # of the seconds, where no pattern is given; at least one run where there are two
    )
    held_out_by: str = (
        RESEMBLANCE  # of tests that do the like one is held out; or chance: the seed draws them
    )


def split_recording(frame: pd.DataFrame, kind: str, split: Split, seed: int = 0) -> dict[str, str]:
    """Divide the runs of a cleaned recording; see `split_runs`.

    Args:
        frame: its samples, uniform in time.
        kind: quadrotor, swerve or joint.
        split: the patterns or fractions.
        seed: for the draw.

    Raises:
        InputError: as `split_runs`.
    """
    times = {run: rows["t"].to_numpy() for run, rows in by_run(frame)}
    runs = list(times)
    if split.validation or split.holdout or len(runs) < 2:
        return split_runs(runs, split, seed)
    seconds = {run: _duration(time) for run, time in times.items()}
    return split_runs(runs, split, seed, distances_of(frame), seconds, opposite_runs(frame, kind))


def _duration(time: NDArray[np.float64]) -> float:
    return len(time) * float(np.median(np.diff(time), overwrite_input=True)) if len(time) > 1 else 0.0


def split_runs(
    runs: Sequence[str],
    split: Split,
    seed: int = 0,
    distances: NDArray[np.float64] | None = None,
    seconds: Mapping[str, float] | None = None,
    opposites: Sequence[tuple[str, str]] = (),
) -> dict[str, str]:
    """Assign each run to train, validation or holdout.

    Args:
        runs: the runs there are.
        split: the patterns or fractions.
        seed: for the draw where fractions decide.
        distances: between the runs, (runs, runs), see `simgap.recordings.resemblance`; None where chance decides.
        seconds: that each run lasts; None where all last equally long.
        opposites: pairs of runs that are the two directions of one test, see `simgap.recordings.opposites`; fractions
            keep them together, if there is another test.

    Returns:
        Run to part, in the order of `runs`. One run alone is trained on.

    Raises:
        InputError: when a fraction is not one, the patterns leave nothing to fit, or there is no such `held_out_by`.
    """
    if not (split.validation or split.holdout):
        return _by_fraction(runs, split, seed, distances, seconds or dict.fromkeys(runs, 1.0), opposites)
    parts = {run: _matched(run, split) for run in runs}
    if runs and "train" not in parts.values():
        raise InputError("no run is left to fit", "dataset.split", "let some run match no pattern")
    return parts


def _matched(run: str, split: Split) -> str:
    for part, patterns in (("holdout", split.holdout), ("validation", split.validation)):
        if any(fnmatchcase(run, pattern) for pattern in patterns):
            return part
    return "train"


def _by_fraction(
    runs: Sequence[str],
    split: Split,
    seed: int,
    distances: NDArray[np.float64] | None,
    seconds: Mapping[str, float],
    opposites: Sequence[tuple[str, str]],
) -> dict[str, str]:
    _check(split)
    place = {run: index for index, run in enumerate(runs)}
    order = np.random.default_rng(seed).permutation(len(runs))
    drawn = [place[sorted(runs)[index]] for index in order]
    pairs = [(place[one], place[other]) for one, other in opposites]
    groups = groups_of(drawn, [seconds[run] for run in runs], pairs)
    known = distances if split.held_out_by == RESEMBLANCE else None
    choose = first if known is None else most_alike(groups, known)
    held = chosen(groups, split.holdout_fraction, choose, at_least_one=True)
    validating = chosen(groups, split.validation_fraction, first, held)
    parts = dict.fromkeys(runs, "train")
    for part, taken in (("holdout", held), ("validation", validating)):
        parts |= {runs[run]: part for group in taken for run in groups.runs[group]}
    return parts


def _check(split: Split) -> None:
    for key in ("validation_fraction", "holdout_fraction"):
        if not 0 <= getattr(split, key) < 1:
            raise InputError(
                f"{getattr(split, key)} is not a fraction", f"dataset.split.{key}", "give 0 to below 1"
            )
    if split.held_out_by not in (RESEMBLANCE, CHANCE):
        where = "dataset.split.held_out_by"
        raise InputError(f"there is no {split.held_out_by!r}", where, f"use {RESEMBLANCE} or {CHANCE}")


def runs_of(split: Mapping[str, str], part: str) -> list[str]:
    """Return the runs of one part."""
    return [run for run, assigned in split.items() if assigned == part]


def require_holdout(split: Mapping[str, str], where: str = "recording") -> None:
    """Check that a run is held out, for stages that need validation.

    Raises:
        InputError: when no run is held out.
    """
    if not runs_of(split, "holdout"):
        remedy = "record a second run" if len(split) < 2 else "name runs in dataset.split.holdout"
        raise InputError("no run can be held out" if len(split) < 2 else "no run is held out", where, remedy)
