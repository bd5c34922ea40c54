"""The large table: every corruption of many recordings, and false alarms on good ones.

Where a corruption is not caught, the whole diagnosis runs, and names that are believed and not true are listed. Where
it is caught, nothing is named.

python -m tests.pipeline.consistency.table --kind joint quadrotor swerve --seed 778 779
"""

import argparse
import itertools
import operator
from collections.abc import Callable, Iterable, Sequence
from dataclasses import astuple, dataclass
from typing import TypeVar

from simgap.api.diagnosing import diagnose
from simgap.benchmark.intervals import Share
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
    """What was made of one corruption.

    Attributes:
        tried: recordings.
        caught: of these.
        right: of these with its cause and column first.
        false: names that are believed and not true, where it was not caught.
    """

    tried: int = 0
    caught: int = 0
    right: int = 0
    false: int = 0

    def __add__(self, other: "Row") -> "Row":
        return Row(*map(operator.add, astuple(self), astuple(other)))


def tell(corruption: Corruption, one: Good) -> Row:
    """Return what is made of a corruption of one recording."""
    spoilt = corruption.of(one.recording, one.platform)
    found = contradictions(spoilt, platform_from_config(one.platform))
    if not found:
        false = false_names(spoilt, one)
        print(f"  believed and not true, with {corruption.name}: {', '.join(false) or 'nothing'}")
        return Row(1, false=len(false))
    first = found[0]
    column = any(name in first.column for name in corruption.column)
    return Row(1, 1, right=int(column and first.suspected in corruption.causes))


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


def mend(fault: RowFault, one: Good) -> Row:
    """Return whether a fault of some rows is said (caught), and whether no contradiction is left of it (right)."""
    spoilt = fault.of(one.recording)
    cleaned, changes = clean_recording(spoilt)
    said = any(fault.said in text for text in (*cleaned.warnings, *changes["reason"]))
    alone = said and not contradictions(spoilt, platform_from_config(one.platform))
    return Row(1, int(said), int(alone))


def tabulate_rows(kind: str, recordings: Iterable[Good], limit: int | None = None) -> dict[str, Row]:
    """Return a row for each fault of rows; arguments as of `tabulate`."""
    faults = ROW_FAULTS.get(kind, ())
    return _tabulated(faults, recordings, limit, lambda fault, good: fault.possible(good.recording), mend)


def _tabulated(
    spoilers: Sequence[Spoiler],
    recordings: Iterable[Good],
    limit: int | None,
    possible: Callable[[Spoiler, Good], bool],
    outcome: Callable[[Spoiler, Good], Row],
) -> dict[str, Row]:
    """Try what spoils recordings on so many of them; `outcome` says what is made of one."""
    rows = {spoiler.name: Row() for spoiler in spoilers}
    for one in recordings:
        for spoiler in spoilers:
            if not possible(spoiler, one) or (limit and rows[spoiler.name].tried >= limit):
                continue
            told = outcome(spoiler, one)
            rows[spoiler.name] += told
            if not told.right:
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
    """Return the table as text, with a line for all."""
    lines = [f"{title:40s} {'tried':>5s} {'caught':>6s} {'right first':>11s} {'not true':>8s}"]
    lines += [
        f"{name:40s} {row.tried:5d} {row.caught:6d} {row.right:11d} {row.false:8d}"
        for name, row in rows.items()
    ]
    return "\n".join([*lines, summary(rows.values())])


def summary(rows: Iterable[Row]) -> str:
    """Return the line of all corruptions, with 95 % intervals of what was caught and of what was rightly."""
    total = sum(rows, Row())
    if not total.tried:
        return "all: none was possible"
    caught, right = (_percent(Share(each, total.tried)) for each in (total.caught, total.right))
    return f"all {total.tried}: caught {caught}, right first {right}, believed and not true {total.false}"


def _percent(share: Share) -> str:
    low, high = share.interval
    return f"{100.0 * share.value:.1f} % ({100.0 * low:.1f}–{100.0 * high:.1f})"


def main() -> None:
    """Print the tables of kinds of machines, and one line for all of them."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--kind", choices=tuple(CORRUPTIONS), nargs="+", required=True)
    parser.add_argument("--seed", type=int, nargs="+", default=[778])
    parser.add_argument("--cases", type=int, default=20)
    parser.add_argument("--each", type=int, default=10, help="recordings that a corruption is tried on")
    parser.add_argument("--rows", action="store_true", help="only the faults of rows")
    chosen = parser.parse_args()
    everything: list[Row] = []
    for kind, seed in itertools.product(chosen.kind, chosen.seed):
        print(f"\n{kind}, seed {seed}", flush=True)
        recordings = list(good(kind, seed, chosen.cases, (1.0, 5.0)))
        usual = [one for one in recordings if one.name.endswith("x1")]
        if not chosen.rows:
            rows = tabulate(kind, usual, chosen.each)
            everything += rows.values()
            print(show(rows))
        print(show(tabulate_rows(kind, usual, chosen.each), "fault of rows: said, and nothing else"))
        count, false = alarms(recordings)
        print(f"false alarms: {len(false)} of {count} good recordings, up to five times as strong as usual")
        print(*false, sep="\n")
    if len(chosen.kind) * len(chosen.seed) > 1 and everything:
        print(f"\nall kinds and seeds\n{summary(everything)}")


if __name__ == "__main__":
    main()
