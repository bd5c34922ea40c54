"""The large table: every corruption of many recordings, and false alarms on good ones.

Where a corruption is not caught, the whole diagnosis runs, and names that are believed and not true are listed. Where
it is caught, nothing is named.

python -m tests.pipeline.consistency.table --kind joint --seed 778 --cases 40
"""

import argparse
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import TypeVar

from simgap.api.diagnosing import diagnose
from simgap.benchmark.measures import BELIEVED
from simgap.consistency import contradictions
from simgap.platforms import platform_from_config
from simgap.recordings.cleaning import clean_recording
from simgap.recordings.recording import Recording
from tests.pipeline.consistency.corruption import CORRUPTIONS, Corruption
from tests.pipeline.consistency.plants import Good, good
from tests.pipeline.consistency.row_faults import ROW_FAULTS, RowFault

Spoiler = TypeVar("Spoiler", Corruption, RowFault)


@dataclass
class Row:
    """What was made of one corruption."""

    tried: int = 0
    caught: int = 0
    right: int = 0


def tell(corruption: Corruption, one: Good) -> tuple[bool, bool]:
    """Return whether a corruption is caught, and whether its cause and column come first."""
    spoilt = corruption.of(one.recording, one.platform)
    found = contradictions(spoilt, platform_from_config(one.platform))
    if not found:
        print(f"  believed and not true, with {corruption.name}: {false_names(spoilt, one) or 'nothing'}")
        return False, False
    first = found[0]
    return True, first.suspected in corruption.causes and any(
        name in first.column for name in corruption.column
    )


def false_names(spoilt: Recording, one: Good) -> list[str]:
    """Return which names a diagnosis of a spoilt recording believes that are not true."""
    effects = diagnose(spoilt, one.platform).effects
    believed = [effect for effect in effects if effect.probability >= BELIEVED]
    return [f"{each.name} {each.probability:.2f}" for each in believed if each.name not in one.effects]


def tabulate(
    kind: str, recordings: Iterable[Good], limit: int | None = None, every: int = 1
) -> dict[str, Row]:
    """Return a row for each corruption.

    Args:
        kind: of machine.
        recordings: good ones.
        limit: how many recordings each corruption is tried on.
        every: of so many corruptions one is tried.
    """
    chosen = CORRUPTIONS[kind][::every]
    return _tabulated(
        chosen, recordings, limit, lambda one, good: one.possible(good.recording, good.platform), tell
    )


def mend(fault: RowFault, one: Good) -> tuple[bool, bool]:
    """Return whether a fault of some rows is said, and whether no contradiction is left of it."""
    spoilt = fault.of(one.recording)
    cleaned, changes = clean_recording(spoilt)
    said = any(fault.said in text for text in (*cleaned.warnings, *changes["reason"]))
    return said, said and not contradictions(spoilt, platform_from_config(one.platform))


def tabulate_rows(kind: str, recordings: Iterable[Good], limit: int | None = None) -> dict[str, Row]:
    """Return a row for each fault of rows; arguments as of `tabulate`."""
    faults = ROW_FAULTS.get(kind, ())
    return _tabulated(faults, recordings, limit, lambda fault, good: fault.possible(good.recording), mend)


def _tabulated(
    spoilers: Sequence[Spoiler],
    recordings: Iterable[Good],
    limit: int | None,
    possible: Callable[[Spoiler, Good], bool],
    outcome: Callable[[Spoiler, Good], tuple[bool, bool]],
) -> dict[str, Row]:
    """Try what spoils recordings on so many of them; `outcome` says whether it was caught, and rightly."""
    rows = {spoiler.name: Row() for spoiler in spoilers}
    for one in recordings:
        for spoiler in spoilers:
            row = rows[spoiler.name]
            if not possible(spoiler, one) or (limit and row.tried >= limit):
                continue
            caught, right = outcome(spoiler, one)
            row.tried, row.caught, row.right = row.tried + 1, row.caught + caught, row.right + right
            if not right:
                print(f"  not right: {spoiler.name} of {one.name}", flush=True)
    return rows


def alarms(recordings: Iterable[Good]) -> tuple[int, list[str]]:
    """Return how many good recordings were checked, and in which something was found."""
    count, false = 0, []
    for one in recordings:
        count += 1
        found = contradictions(one.recording, platform_from_config(one.platform))
        if found:
            false.append(f"{one.name}: {found[0].sentence}")
    return count, false


def show(rows: dict[str, Row], title: str = "corruption") -> str:
    """Return the table as text."""
    lines = [f"{title:40s} {'tried':>5s} {'caught':>6s} {'right first':>11s}"]
    lines += [f"{name:40s} {row.tried:5d} {row.caught:6d} {row.right:11d}" for name, row in rows.items()]
    tried, caught, right = (
        sum(getattr(row, key) for row in rows.values()) for key in ("tried", "caught", "right")
    )
    share = 100.0 / max(tried, 1)
    lines.append(f"{'all':40s} {tried:5d} {caught * share:5.1f}% {right * share:10.1f}%")
    return "\n".join(lines)


def main() -> None:
    """Print the table of a kind."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--kind", choices=tuple(CORRUPTIONS), required=True)
    parser.add_argument("--seed", type=int, default=778)
    parser.add_argument("--cases", type=int, default=20)
    parser.add_argument("--each", type=int, default=10, help="recordings that a corruption is tried on")
    parser.add_argument("--rows", action="store_true", help="only the faults of rows")
    chosen = parser.parse_args()
    recordings = list(good(chosen.kind, chosen.seed, chosen.cases, (1.0, 5.0)))
    usual = [one for one in recordings if one.name.endswith("x1")]
    if not chosen.rows:
        print(show(tabulate(chosen.kind, usual, chosen.each)))
    print(show(tabulate_rows(chosen.kind, usual, chosen.each), "fault of rows: said, and nothing else"))
    count, false = alarms(recordings)
    print(
        f"false alarms: {len(false)} of {count} good recordings, effects up to five times as strong as usual"
    )
    print(*false, sep="\n")


if __name__ == "__main__":
    main()
