"""Division of whole runs into training, validation and hold-out."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fnmatch import fnmatchcase

import numpy as np
from numpy.typing import NDArray

from simgap.errors import InputError

PARTS = ("train", "validation", "holdout")
_DECIMALS = 6  # of a distance, beyond which runs resemble each other alike
RESEMBLANCE, CHANCE = "resemblance", "chance"


@dataclass
class Split:
    """How the runs of a dataset are divided.

    Patterns name runs as file names are matched (`melon_*`); a run that no pattern names is trained on.
    Without any pattern the fractions say how many runs go where. Which ones are held out says how much they resemble
    each other: a run that is alone in what it does has to be fitted, or nothing can be learned from it.
    """

    validation: list[str] = field(default_factory=list)  # patterns of runs to choose a model by
    holdout: list[str] = field(default_factory=list)  # patterns of runs to prove a result on
    validation_fraction: float = 0.15  # of the runs, where no pattern is given
    holdout_fraction: float = 0.25  # of the runs, where no pattern is given; at least one where there are two
    held_out_by: str = RESEMBLANCE  # of runs that do the like one is held out; or chance: the seed draws them


def split_runs(
    runs: Sequence[str], split: Split, seed: int = 0, distances: NDArray[np.float64] | None = None
) -> dict[str, str]:
    """Assign each run to train, validation or holdout.

    Args:
        runs: the runs there are.
        split: the patterns or fractions.
        seed: for the draw where fractions decide.
        distances: between the runs, (runs, runs), see `simgap.recordings.resemblance`; None where chance decides.

    Returns:
        Run to part, in the order of `runs`. One run alone is trained on.

    Raises:
        InputError: when a fraction is not one, the patterns leave nothing to fit, or there is no such `held_out_by`.
    """
    if not (split.validation or split.holdout):
        return _by_fraction(runs, split, seed, distances)
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
    runs: Sequence[str], split: Split, seed: int, distances: NDArray[np.float64] | None
) -> dict[str, str]:
    _check(split)
    count = len(runs)
    held = min(max(round(split.holdout_fraction * count), 1), count - 1) if split.holdout_fraction else 0
    chosen = min(round(split.validation_fraction * count), count - 1 - held)
    order = np.random.default_rng(seed).permutation(count)
    drawn = [sorted(runs)[index] for index in order]
    if distances is not None and split.held_out_by == RESEMBLANCE:
        places = [list(runs).index(run) for run in drawn]
        drawn = [drawn[index] for index in _most_alike_first(distances[np.ix_(places, places)], held)]
    part = dict.fromkeys(drawn, "train")
    part |= dict.fromkeys(drawn[:held], "holdout")
    part |= dict.fromkeys(drawn[held : held + max(chosen, 0)], "validation")
    return {run: part[run] for run in runs}


def _check(split: Split) -> None:
    for key in ("validation_fraction", "holdout_fraction"):
        if not 0 <= getattr(split, key) < 1:
            raise InputError(
                f"{getattr(split, key)} is not a fraction", f"dataset.split.{key}", "give 0 to below 1"
            )
    if split.held_out_by not in (RESEMBLANCE, CHANCE):
        where = "dataset.split.held_out_by"
        raise InputError(f"there is no {split.held_out_by!r}", where, f"use {RESEMBLANCE} or {CHANCE}")


def _most_alike_first(distances: NDArray[np.float64], count: int) -> list[int]:
    """Return the indices of the runs, first the `count` runs that most resemble one of the others.

    Of two that are nearest to each other, that is the one which is nearer to all.
    """
    left, first = list(range(len(distances))), []
    for _ in range(count):
        among = distances[np.ix_(left, left)].round(_DECIMALS)
        nearest = np.where(np.eye(len(left), dtype=bool), np.inf, among).min(axis=1)
        first.append(left.pop(np.lexsort((among.sum(axis=1), nearest))[0]))
    return [*first, *left]


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
