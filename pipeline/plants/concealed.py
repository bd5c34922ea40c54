"""Drawing of cases: a recordable case and its published platform, from a subject."""

import importlib
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from itertools import islice
from typing import Any

import numpy as np

from simgap.errors import InputError
from simgap.plants.agenda import Subject, subjects
from simgap.plants.concealment import Table, components, typical
from simgap.plants.draw import draw_conditions, draw_effect, merged, vary_platform
from simgap.plants.kinds import case_from_config, record_case
from simgap.platforms import platform_from_config
from simgap.recordings.recording import Recording

KINDS = ("quadrotor", "joint", "swerve")

_TABLE_MODULES = {
    "quadrotor": "simgap.plants.concealable",
    "joint": "simgap.plants.joint.effects",
    "swerve": "simgap.plants.swerve.effects",
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
        hiding: conditions in the place of those by which a driver is not recorded.
        seed: of paths and noise.
    """

    kind: str
    number: int
    subject: Subject
    machine: str
    platform: dict[str, Any]
    record: dict[str, Any]
    hiding: dict[str, Any]
    seed: int

    @property
    def wanted(self) -> tuple[str, ...]:
        """The one effect that the case is about, if it is about one: it has to be named even where it is not alone."""
        return (
            self.subject.names if len(self.subject.names) == 1 and self.subject.category != "outside" else ()
        )

    @property
    def plain(self) -> dict[str, Any]:
        """Everything about it as mappings, lists, texts and numbers."""
        return asdict(self)

    @property
    def effects(self) -> tuple[str, ...]:
        """The effects that it is about and that the catalogue has."""
        return tuple(name for name in self.subject.names if name in self.record.get("effects", {}))

    @property
    def shown(self) -> "ConcealedCase":
        """The same machine and motion with every driver recorded."""
        return replace(self, hiding={})

    @property
    def begun_later(self) -> "ConcealedCase":
        """The same machine and motion, whose effects begin between two runs in the middle; drawn by its own seed."""
        runs = case_from_config(self.kind, self.record).runs
        first = int(np.random.default_rng([self.seed, 1]).integers(2, max(runs, 3)))
        return replace(self, record=self.record | {"begins_in_run": first})

    def scaled(self, effect: str, factor: float) -> "ConcealedCase":
        """Return the same machine and motion with an effect that many times as strong."""
        quantities, values = _known(self.kind, "effects")[effect], dict(self.record["effects"][effect])
        for name in components(quantities):
            values[name] = quantities[name].scaled(values[name], factor)
        return replace(self, record=self.record | {"effects": self.record["effects"] | {effect: values}})


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
    parts = _parts(table, subject)
    entries = [table[section][name] for section, name in parts]
    hidden = table["hidden"][subject.condition] if subject.category == "hidden" else {}
    if subject.category == "ambiguous":
        # Where an effect cannot be told is not where it shows: the condition stands in for the effect's own.
        entries[0] = merged(entries[0], table["ambiguous"][subject.condition])
    machine, platform = vary_platform(_able(machines, [*entries, hidden]), table.get("vary", {}), random)
    record = draw_conditions(merged(table["conditions"], table["machines"][machine]), random)
    for entry in entries:
        record |= draw_conditions(entry.get("record", {}), random)
    size = _size(kind, record, platform)
    around = float(table.get("around", 0.0))
    hiding = draw_conditions(hidden.get("record", {}), random)
    for section, name in parts:
        quantities = _known(kind, section)[name]
        values = typical(name, _known(kind, section), size)
        record.setdefault(section, {})[name] = draw_effect(quantities, values, around, random)
    return ConcealedCase(kind, number, subject, machine, platform, record, hiding, own)


def record_concealed(case: ConcealedCase) -> tuple[Recording, dict[str, Any]]:
    """Record a case: the recording, whose source names the hash of the key, and the key."""
    platform = platform_from_config(case.platform)
    return record_case(case_from_config(case.kind, case.record | case.hiding), platform, case.seed)


def _parts(table: Mapping[str, Any], subject: Subject) -> list[tuple[str, str]]:
    """Return section and name of what a subject conceals, with what has to be there for it to show (`beside`)."""
    own = [("effects" if name in table["effects"] else "outside", name) for name in subject.names]
    beside = [name for section, part in own for name in table[section][part].get("beside", ())]
    return own + [("effects", name) for name in beside if name not in subject.names]


def _able(
    machines: Mapping[str, Mapping[str, Any]], entries: Sequence[Mapping[str, Any]]
) -> dict[str, Mapping[str, Any]]:
    """Return the machines that can do all that the entries ask for."""
    lists = [entry["machines"] for entry in entries if "machines" in entry]
    able = {name: told for name, told in machines.items() if all(name in names for names in lists)}
    if not able:
        raise InputError(f"no machine is in all of {lists}", "prove", "keep such effects `apart`")
    return able


def _known(kind: str, section: str) -> Table:
    module = importlib.import_module(_TABLE_MODULES[kind])
    return module.CONCEALABLE if section == "effects" else module.OUTSIDE


def _size(kind: str, record: Mapping[str, Any], platform: Mapping[str, Any]) -> Any:
    """Return what is typical of a machine at work, in which the plants' tables are written."""
    told: Any = platform_from_config(dict(platform))
    case: Any = case_from_config(kind, record)
    return (
        case.size(told)
        if hasattr(case, "size")
        else importlib.import_module(_TABLE_MODULES[kind]).machine_size(told)
    )
