"""Settings of the benchmark."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Any

from simgap.artifacts import PACKAGE, hash_path, hash_value
from simgap.errors import InputError

_DECIDING = (
    "diagnosis",
    "effects",
    "equations",
    "gap",
    "physics",
    "platforms",
    "plants",
    "recordings",
    "simulation",
)


@dataclass
class Benchmark:
    """Settings of the concealed benchmark; see conf/prove/default.yaml."""

    kinds: list[str] = field(default_factory=list)
    """Kinds whose cases are drawn."""
    cases: int = 60
    """Cases of each kind."""
    jobs: int = 2
    """Processes side by side."""
    folder: str | None = None
    """Where results are kept case by case; `concealed` beside the stage's output when null."""
    keep: bool = False
    """Whether recordings and reports of the cases are kept."""
    write_docs: bool = False
    """Whether docs/proof.md is written."""
    begins_later: bool = False
    """Whether the effects of each case begin between two runs in the middle."""
    results: list[str] = field(default_factory=list)
    """Results of benchmarks that probabilities are calibrated on."""
    write_calibration: bool = False
    """Whether the coefficients take the place of those that the diagnosis reads."""
    shares: dict[str, float] = field(default_factory=dict)
    """Of the categories of cases."""
    quadrotor: dict[str, Any] = field(default_factory=dict)
    """What is drawn for a quadrotor."""
    joint: dict[str, Any] = field(default_factory=dict)
    """What is drawn for a joint."""
    swerve: dict[str, Any] = field(default_factory=dict)
    """What is drawn for a swerve drive."""
    real: dict[str, Any] = field(default_factory=dict)
    """What is known of published recordings, by branch."""


def table_of(settings: Benchmark, kind: str) -> Mapping[str, Any]:
    """Return what is drawn for a kind.

    Raises:
        InputError: when there is no such table.
    """
    table: Mapping[str, Any] = getattr(settings, kind, {})
    if not table:
        raise InputError(
            f"nothing is drawn for {kind!r}", "prove.kinds", "use quadrotor, joint, swerve or real"
        )
    return table


@cache
def hash_of_code() -> str:
    """Return the hash of the code that recordings and answers depend on."""
    files = sorted(
        path for part in _DECIDING for path in (PACKAGE / part).rglob("*") if path.suffix in {".py", ".yaml"}
    )
    return hash_value({str(path.relative_to(PACKAGE)): hash_path(path) for path in files})
