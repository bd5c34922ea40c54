"""Runs are divided whole: what a model is fitted on, chosen by and proven on never share a flight."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fnmatch import fnmatchcase

import numpy as np

from pipeline.errors import InputError

PARTS = ("train", "validation", "holdout")


@dataclass
class Split:
    """How the runs of a dataset are divided.

    Patterns name runs as file names are matched (`melon_*`); a run that no pattern names is trained on.
    Without any pattern the fractions say how many runs, drawn with the seed, go where.
    """

    validation: list[str] = field(default_factory=list)  # patterns of runs to choose a model by
    holdout: list[str] = field(default_factory=list)  # patterns of runs to prove a result on
    validation_fraction: float = 0.15  # of the runs, where no pattern is given
    holdout_fraction: float = 0.25  # of the runs, where no pattern is given; at least one where there are two


def split_runs(runs: Sequence[str], split: Split, seed: int = 0) -> dict[str, str]:
    """Assign each run to train, validation or holdout.

    Args:
        runs: the runs there are.
        split: the patterns or fractions.
        seed: for the draw where fractions decide.

    Returns:
        Run to part, in the order of `runs`. One run alone is trained on.

    Raises:
        InputError: when a fraction is not one, or the patterns leave nothing to fit.
    """
    if not (split.validation or split.holdout):
        return _by_fraction(runs, split, seed)
    parts = {run: _matched(run, split) for run in runs}
    if runs and "train" not in parts.values():
        raise InputError("no run is left to fit", "dataset.split", "let some run match no pattern")
    return parts


def _matched(run: str, split: Split) -> str:
    for part, patterns in (("holdout", split.holdout), ("validation", split.validation)):
        if any(fnmatchcase(run, pattern) for pattern in patterns):
            return part
    return "train"


def _by_fraction(runs: Sequence[str], split: Split, seed: int) -> dict[str, str]:
    for key in ("validation_fraction", "holdout_fraction"):
        if not 0 <= getattr(split, key) < 1:
            raise InputError(
                f"{getattr(split, key)} is not a fraction", f"dataset.split.{key}", "give 0 to below 1"
            )
    count = len(runs)
    held = min(max(round(split.holdout_fraction * count), 1), count - 1) if split.holdout_fraction else 0
    chosen = min(round(split.validation_fraction * count), count - 1 - held)
    order = np.random.default_rng(seed).permutation(count)
    drawn = [sorted(runs)[index] for index in order]
    part = dict.fromkeys(drawn, "train")
    part |= dict.fromkeys(drawn[:held], "holdout")
    part |= dict.fromkeys(drawn[held : held + max(chosen, 0)], "validation")
    return {run: part[run] for run in runs}


def runs_of(split: Mapping[str, str], part: str) -> list[str]:
    """Return the runs of one part."""
    return [run for run, assigned in split.items() if assigned == part]


def require_holdout(split: Mapping[str, str], where: str = "recording") -> None:
    """Refuse to go on where nothing is held out, for what is worth nothing without a proof.

    Raises:
        InputError: when no run is held out.
    """
    if not runs_of(split, "holdout"):
        remedy = "record a second run" if len(split) < 2 else "name runs in dataset.split.holdout"
        raise InputError("no run can be held out" if len(split) < 2 else "no run is held out", where, remedy)
