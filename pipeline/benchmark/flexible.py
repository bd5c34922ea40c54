"""How much of a simulator's error the recorded signals explain at all: what a flexible regression makes of them.

It names nothing, and knows no physics. What it leaves on held-out runs, no law of these signals is shown to explain;
what it explains, named effects should explain, too.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

_LABELS = ["run", "t", "before", "after", "part", "channel", "unit", "elapsed"]
_BEFORE = (1, 2)
"""Windows before each one whose commands are looked at, too: what remembers shows there. Not so the motion: with its
change a regression would not explain the force, but measure it.
"""
_APART = 1.5  # of the usual distance of two windows; more is another block
_ENOUGH = 0.8  # the target: of what can be explained
_TREES, _FEWEST = 200, 5  # of the forest, and windows in a leaf: scikit-learn's doubled, against noise
_PENALTY = 1.0  # of the linear part, with features of unit variance: scikit-learn's


@dataclass(frozen=True)
class Explained:
    """Shares of the error of the nominal simulator on held-out runs, over the channels in which it fails.

    Attributes:
        named: by how much the named effects lower it.
        flexible: by how much the regression does; 0 where it does not.
    """

    named: float
    flexible: float

    @property
    def enough(self) -> bool:
        """Whether the named effects explain four fifths of what the regression does."""
        return self.named >= _ENOUGH * self.flexible


def explained(evidence: Path, channels: Sequence[str]) -> Explained | None:
    """Return what the named effects and a flexible regression explain on held-out runs.

    The regression is linear with an ensemble of extremely randomised trees on its residual (Geurts, Ernst & Wehenkel
    2006, Machine Learning 63). Its inputs are the means of all recorded signals over a window, and of the commands
    over the two before it.

    Args:
        evidence: folder of a diagnosis with held-out runs.
        channels: those in which the nominal simulator fails; none: all.

    Returns:
        None where too little was recorded for a regression.
    """
    table = pd.read_parquet(evidence / "residuals.parquet")
    wanted = [name for name in table["channel"].unique() if not channels or name in channels]
    left = [_left(table[table["channel"] == name]) for name in wanted]
    found = np.array([each for each in left if each is not None])
    if not len(found):
        return None
    named, flexible = 1.0 - np.sqrt(found.mean(0))
    return Explained(float(named), max(float(flexible), 0.0))


def _left(rows: pd.DataFrame) -> tuple[float, float] | None:
    """Return the energies that names and regression leave of one channel on held-out runs, over that before."""
    from sklearn.ensemble import ExtraTreesRegressor  # of an extra that few need
    from sklearn.linear_model import Ridge
    from sklearn.pipeline import make_pipeline
    from sklearn.preprocessing import StandardScaler

    rows = rows.sort_values(["part", "run", "t"])
    inputs, error = _inputs(rows), rows["before"].to_numpy()
    fitted, held_out = ((rows["part"] == part).to_numpy() for part in ("train", "holdout"))
    energy = float(np.square(error[held_out]).mean()) if held_out.any() else 0.0
    if fitted.sum() < 2 * _FEWEST or energy == 0.0:
        return None
    line = make_pipeline(StandardScaler(), Ridge(_PENALTY)).fit(inputs[fitted], error[fitted])
    error = error - line.predict(inputs)
    forest = ExtraTreesRegressor(_TREES, min_samples_leaf=_FEWEST, random_state=0)
    error = error - forest.fit(inputs[fitted], error[fitted]).predict(inputs)
    named, flexible = (
        np.square(each[held_out]).mean() / energy for each in (rows["after"].to_numpy(), error)
    )
    return float(named), float(flexible)


def _inputs(rows: pd.DataFrame) -> np.ndarray:
    """Return signals of each window and commands before it, (windows, features); a beginning repeats its own."""
    signals = rows.drop(columns=[name for name in _LABELS if name in rows])
    names = _commands([str(name) for name in signals.columns])
    commands = signals[names]
    step = rows["t"].diff().abs().median()
    groups = rows.groupby(["part", "run"], sort=False)
    parts = [signals]
    for before in _BEFORE if names else ():
        earlier = groups[names].shift(before)
        near = rows["t"] - groups["t"].shift(before) < (before - 1 + _APART) * step
        parts.append(earlier.where(near, commands).fillna(commands))
    return np.concatenate([part.to_numpy(float) for part in parts], axis=1)


def _commands(names: Sequence[str]) -> list[str]:
    """Return the signals that are commands: the voltages, else the effort of an axis."""
    voltages = [name for name in names if name == "voltage" or name.startswith("drive_voltage")]
    return voltages or [name for name in names if name == "effort"]
