"""From the subject of a case to a case that can be recorded, and the machine that the person is told of."""

import importlib
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from itertools import islice
from typing import Any

import numpy as np

from pipeline.errors import InputError
from pipeline.platforms import platform_from_config
from pipeline.reality.agenda import Subject, subjects
from pipeline.reality.concealment import Table, typical
from pipeline.reality.draw import draw_conditions, draw_effect, merged, vary_platform
from pipeline.reality.kinds import case_from_config, record_case
from pipeline.recordings.recording import Recording

KINDS = ("quadrotor", "joint", "swerve")

_TABLES = {
    "quadrotor": "pipeline.reality.concealable",
    "joint": "pipeline.reality.joint.effects",
    "swerve": "pipeline.reality.swerve.effects",
}


@dataclass(frozen=True)
class ConcealedCase:
    """A case of a benchmark that is ready to be recorded.

    Attributes:
        kind: of platform.
        number: among the cases of its seed.
        subject: what it is about; only who scores it may know.
        machine: the name of the platform it was varied from.
        platform: what the person is told of the machine, as a platform file.
        record: conditions and what is concealed, as the configuration group `record` has them.
        seed: of paths and noise.
    """

    kind: str
    number: int
    subject: Subject
    machine: str
    platform: dict[str, Any]
    record: dict[str, Any]
    seed: int

    @property
    def plain(self) -> dict[str, Any]:
        """Everything about it as mappings, lists, texts and numbers."""
        return asdict(self)


def draw_cases(
    kind: str,
    table: Mapping[str, Any],
    shares: Mapping[str, float],
    machines: Mapping[str, Mapping[str, Any]],
    seed: int,
    count: int,
) -> list[ConcealedCase]:
    """Draw the first cases of a benchmark; the n-th is the same however many are asked for.

    Args:
        kind: of platform.
        table: of the kind (`conf/prove/KIND.yaml`).
        shares: of the categories.
        machines: platform files by name.
        seed: of the benchmark.
        count: how many.

    Raises:
        InputError: when the table does not fit the plants.
    """
    if kind not in KINDS:
        raise InputError(f"unknown kind {kind!r}", "prove.kinds", f"use some of {', '.join(KINDS)}")
    order = islice(subjects(table, shares, seed), count)
    return [draw_case(kind, table, machines, seed, number, subject) for number, subject in enumerate(order)]


def draw_case(
    kind: str,
    table: Mapping[str, Any],
    machines: Mapping[str, Mapping[str, Any]],
    seed: int,
    number: int,
    subject: Subject,
) -> ConcealedCase:
    """Draw machine, conditions and magnitudes of one case."""
    own, drawn = np.random.SeedSequence([seed, KINDS.index(kind), number]).generate_state(2).tolist()
    random = np.random.default_rng(drawn)
    entries = _entries(table, subject)
    machine, platform = vary_platform(_able(machines, entries), table.get("vary", {}), random)
    record = draw_conditions(merged(table["conditions"], table["machines"][machine]), random)
    for entry in entries.values():
        record |= draw_conditions(entry.get("record", {}), random)
    if subject.category in ("hidden", "ambiguous"):
        record |= draw_conditions(table[subject.category][subject.condition].get("record", {}), random)
    section = "outside" if subject.category == "outside" else "effects"
    known = _known(kind, section)
    size = _size(kind, record, platform)
    record[section] = {
        name: draw_effect(
            known[name],
            typical(name, known, size, float(entry[subject.strength])),
            float(table.get("around", 0.0)),
            random,
        )
        for name, entry in entries.items()
    }
    return ConcealedCase(kind, number, subject, machine, platform, record, own)


def record_concealed(case: ConcealedCase) -> tuple[Recording, dict[str, Any]]:
    """Record a case: the recording, whose source names the hash of the key, and the key."""
    platform = platform_from_config(case.platform)
    return record_case(case_from_config(case.kind, case.record), platform, case.seed)


def _entries(table: Mapping[str, Any], subject: Subject) -> dict[str, Mapping[str, Any]]:
    strengths = table["outside"] if subject.category == "outside" else table["effects"]
    return {name: strengths[name] for name in subject.names}


def _able(
    machines: Mapping[str, Mapping[str, Any]], entries: Mapping[str, Mapping[str, Any]]
) -> dict[str, Mapping[str, Any]]:
    """Return the machines that can conceal all of the entries."""
    lists = [entry["machines"] for entry in entries.values() if "machines" in entry]
    able = {name: told for name, told in machines.items() if all(name in names for names in lists)}
    if not able:
        raise InputError(f"no machine has all of {', '.join(entries)}", "prove", "keep them `apart`")
    return able


def _known(kind: str, section: str) -> Table:
    module = importlib.import_module(_TABLES[kind])
    return module.CONCEALABLE if section == "effects" else module.OUTSIDE


def _size(kind: str, record: Mapping[str, Any], platform: Mapping[str, Any]) -> Any:
    """Return what is typical of a machine at work, in which the plants' tables are written."""
    told: Any = platform_from_config(dict(platform))
    case: Any = case_from_config(kind, record)
    return (
        case.size(told)
        if hasattr(case, "size")
        else importlib.import_module(_TABLES[kind]).machine_size(told)
    )
