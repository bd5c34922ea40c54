"""A proposed mapping: which signal is which column, how sure that is, and what is missing."""

import importlib
from collections.abc import Mapping as AbstractMapping
from dataclasses import dataclass, field

from simgap.logs.log import Log, Span
from simgap.logs.mapping import Mapping, Source
from simgap.recordings.contract import ANY_OF, required_channels

SURE = 0.9
"""Confidence from which on a proposed column is used without asking, as a name of 0.9 is right in nine of ten."""

LAYOUTS: tuple[str, ...] = (
    "wpilib",
    "sysid_json",
    "px4",
    "ardupilot",
    "betaflight",
    "ros",
    "lerobot",
    "crazyflie",
)
"""Modules in `simgap.logs.layouts` with `propose(log, kind) -> Proposal | None`, each for logs of one software."""


@dataclass(frozen=True)
class Proposed:
    """A proposed column.

    Attributes:
        source: where it comes from.
        confidence: from 0 to 1.
        reason: why, in a few words.
    """

    source: Source
    confidence: float
    reason: str


@dataclass(frozen=True)
class Proposal:
    """A proposed mapping.

    Attributes:
        kind: quadrotor, swerve or joint; None where the log fits none.
        columns: column of the contract to what is proposed.
        missing: what the kind still needs, and how to log it: column (or a group) to a sentence.
        windows: proposed runs, where the log marks none.
        notes: sentences for a person: what the log shows of the machine, what its rates allow.
        refusal: why a diagnosis makes no sense at all: nothing moves, not a quadrotor; empty where it does.
        rate: samples per second of the recording; None where the slowest of the measured signals sets them.
        places: signs of x and y of each rotor, in the order of the log; empty where it does not say them.
    """

    kind: str | None
    columns: AbstractMapping[str, Proposed]
    missing: AbstractMapping[str, str] = field(default_factory=dict)
    windows: tuple[Span, ...] = ()
    notes: tuple[str, ...] = ()
    refusal: str = ""
    rate: float | None = None
    places: tuple[tuple[int, int], ...] = ()

    @property
    def is_sure(self) -> bool:
        """Whether all that is needed is there and sure."""
        return (
            self.kind is not None
            and not self.refusal
            and not lacking(self.kind, set(self.columns))
            and all(proposed.confidence >= SURE for proposed in self.columns.values())
        )

    def mapping(self) -> Mapping:
        """Return the mapping that is proposed; its kind must be known."""
        assert self.kind is not None
        columns = {name: entry.source for name, entry in self.columns.items()}
        return Mapping(self.kind, columns, self.windows, self.rate)


def propose(log: Log, kind: str | None = None) -> Proposal:
    """Propose a mapping of a log's signals to the columns of the contract.

    Args:
        log: as it was read.
        kind: what it is a recording of, where that is known.
    """
    for layout in LAYOUTS:
        found: Proposal | None = importlib.import_module(f"simgap.logs.layouts.{layout}").propose(log, kind)
        if found is not None:
            return found
    guessed: Proposal = importlib.import_module("simgap.logs.guess").guess(log, kind)
    return guessed


def lacking(kind: str, columns: set[str]) -> list[str]:
    """Return the required columns that are not there; of groups of which one is needed, that of the first."""
    lost = [column for column in required_channels(kind, columns) if column not in columns]
    groups = ANY_OF[kind]
    if groups and not any(set(group) <= columns for group in groups):
        begun = max(groups, key=lambda group: len(columns & set(group)))
        lost += [column for column in begun if column not in columns]
    return lost


def grouped(columns: list[str]) -> str:
    """Return names of columns, four that differ by their number as one: 'drive_voltage_1..4'."""
    named = []
    for column in columns:
        four = [f"{column[:-1]}{number}" for number in range(1, 5)]
        named.append(f"{column}..4" if column == four[0] and set(four) <= set(columns) else column)
    covered = {f"{name[:-4]}{number}" for name in named if name.endswith("..4") for number in range(2, 5)}
    return ", ".join(repr(name) for name in named if name not in covered)
