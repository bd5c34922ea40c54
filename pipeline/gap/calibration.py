"""Recalibration: the posterior probability of an effect, corrected by how often such probabilities were right.

An effect that explains a small part of the error, even where it explains most, is wrong more often than one that
explains all of it: it may make up for what the cause has left.
"""

import ast
import hashlib
import json
import math
from dataclasses import dataclass, fields
from functools import cache
from pathlib import Path
from typing import Any

import yaml

_PACKAGE = Path(__file__).resolve().parents[1]

CALIBRATION = _PACKAGE / "gap" / "calibration.yaml"
"""The file of the three numbers, and of what they were fitted to."""

MODULES = (
    "effects/dry_friction",
    "effects/parameter",
    "effects/sizes",
    "equations/command_gain",
    "equations/derived_noise",
    "equations/encoder",
    "equations/fit",
    "equations/mixture_steps",
    "equations/noise_ceiling",
    "equations/passed_noise",
    "equations/presence",
    "equations/problem",
    "equations/recent",
    "equations/refit",
    "equations/residuals",
    "equations/resolution",
    "equations/row_noise",
    "equations/sample_noise",
    "equations/starts",
    "equations/temper",
    "equations/trend",
    "equations/width",
    "gap/changes",
    "gap/driver_law",
    "gap/gains",
    "gap/hypothesis",
    "gap/latent_inputs",
    "gap/likelihood",
    "gap/neighbours",
    "gap/partly",
    "gap/posterior",
    "gap/prepare",
    "gap/prior",
    "gap/reading",
    "gap/scales",
    "gap/search",
    "gap/trends",
)
"""The modules of the package that decide a score. A change of one of them makes the calibration stale."""

_MARGIN = 1e-3
"""Closest to 0 and to 1 that a posterior probability is taken at its word.

The fit has some hundred statements. They cannot show an error rate below one in a thousand.
"""


@dataclass(frozen=True)
class Calibration:
    """A linear correction of the log odds.

    Source: Cox 1958, Two further applications of a model for binary regression (Biometrika 45).

    Attributes:
        intercept: added to the log odds.
        slope: multiplies the log odds; above zero, so that the order of probabilities is kept.
        unexplained: taken off, times the share of the error that an effect leaves where it explains most.
    """

    intercept: float
    slope: float
    unexplained: float = 0.0

    def __post_init__(self) -> None:
        if not self.slope > 0.0:
            raise ValueError(f"the slope of a calibration must be above zero, not {self.slope}")

    def __call__(self, probability: float, share: float = 1.0) -> float:
        """Return the corrected probability.

        Args:
            probability: that the posterior gives.
            share: of the error that the effect explains in the channel where it explains most.
        """
        odds = self.intercept + self.slope * log_odds(probability) - self.unexplained * (1.0 - share)
        return 1.0 / (1.0 + math.exp(-odds))


def calibrated(probability: float, share: float) -> float:
    """Return the probability to state for an effect, from the one that the posterior gives.

    A greater posterior probability never becomes a smaller one. Those within a thousandth of 0 or of 1 become equal.

    Args:
        probability: that the posterior gives.
        share: of the error that the effect explains in the channel where it explains most.
    """
    return _stored()(probability, share)


def log_odds(probability: float) -> float:
    """Return ln(p / (1 − p)) of a probability that is first limited to a thousandth from 0 and from 1."""
    kept = min(max(probability, _MARGIN), 1.0 - _MARGIN)
    return math.log(kept / (1.0 - kept))


@cache
def _stored() -> Calibration:
    content = yaml.safe_load(CALIBRATION.read_text(encoding="utf-8"))
    return Calibration(*(float(content[each.name]) for each in fields(Calibration)))


def hash_of_score(folder: Path = _PACKAGE) -> str:
    """Return the SHA-256 of the code that decides a score, in hexadecimal digits.

    Comments, docstrings and layout do not count, and every version of Python gives the same hash.

    Args:
        folder: of the package; a module that is not there is left out.
    """
    paths = {name: path for name in MODULES if (path := folder / f"{name}.py").is_file()}
    trees = {name: _plain(ast.parse(path.read_text(encoding="utf-8"))) for name, path in paths.items()}
    return hashlib.sha256(json.dumps(trees, sort_keys=True).encode()).hexdigest()


def _plain(node: Any) -> Any:
    """Return a syntax tree as plain values, without strings that stand alone and without empty fields.

    `ast.dump` would do, but some versions of Python have fields that others lack; in this code they are empty.
    """
    if isinstance(node, list):
        return [_plain(entry) for entry in node if not _is_docstring(entry)]
    if not isinstance(node, ast.AST):
        return repr(node)
    if isinstance(node, ast.JoinedStr):  # Python 3.12 adds an empty string to a nested format
        node.values = [value for value in node.values if getattr(value, "value", None) != ""]
    fields = {name: _plain(value) for name, value in ast.iter_fields(node) if value not in (None, [])}
    return [type(node).__name__, fields]


def _is_docstring(node: Any) -> bool:
    """Whether a node is a string that stands alone: it documents the module, class, function or constant before it."""
    return (
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    )
