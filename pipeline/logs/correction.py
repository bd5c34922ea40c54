"""Lines of a mapping that correct what was proposed: `body_rate_x: {from: body_rate_x, unit: deg/s}`."""

from collections.abc import Mapping as AbstractMapping
from dataclasses import replace
from typing import Any

from simgap.errors import InputError
from simgap.logs.log import Log
from simgap.logs.mapping import Mapping, Source
from simgap.logs.proposal import Proposal, Proposed, propose
from simgap.logs.rotor_order import by_place
from simgap.recordings.contract import channel_units
from simgap.recordings.units import conversion


def corrected(
    log: Log, mapping: Mapping, name: str, platform: AbstractMapping[str, Any] | None = None
) -> Proposal | None:
    """Return the proposal for a log with corrections; None where a mapping names the log's own signals alone.

    A line whose `from` is a column of the contract, and no signal of the log, means what the proposal takes for that
    column, in the contract's unit. If all lines do, the rest is as proposed; else it is as the other lines say.

    Args:
        log: that both are of.
        mapping: as a person gives it.
        name: of its file.
        platform: its keys, where it is known: motors are proposed in the order of its rotors.

    Raises:
        InputError: when a line needs more than one signal, or names a column for which nothing is proposed.
    """
    units = channel_units(mapping.kind)
    columns = mapping.columns.items()
    lines = {c: each for c, each in columns if each.signal in units and each.signal not in log.signals}
    if not lines:
        return None
    found = by_place(propose(log, mapping.kind), platform)
    base = found.columns if len(lines) == len(mapping.columns) else {}
    given = {column: Proposed(each, 1.0, f"as {name} says") for column, each in columns}
    for column, line in lines.items():
        place = f"{name}, {column}"
        given[column] = replace(given[column], source=_upon(line, found.columns, units, place))
    windows, rate = mapping.windows or found.windows, mapping.rate or found.rate
    return replace(found, columns={**base, **given}, windows=windows, rate=rate)


def _upon(
    line: Source, proposed: AbstractMapping[str, Proposed], units: AbstractMapping[str, str], place: str
) -> Source:
    """Return the source that a line makes of the proposed one."""
    if line.signal not in proposed:
        raise InputError(
            f"there is no signal {line.signal!r}, and none is proposed for it",
            place,
            "name a signal of the log",
        )
    if line.times or line.ratio or line.offset or line.integrate:
        raise InputError(
            f"{line.signal!r} is no signal of the log", place, "name the signal that simgap inspect lists"
        )
    source = proposed[line.signal].source
    unit = line.unit and conversion(line.unit)
    factor = line.sign * line.scale * (unit[1] if unit else 1.0)
    factor = factor * abs(factor) if source.root else factor  # the root is taken last
    return replace(
        source,
        sign=1,
        scale=source.sign * source.scale * factor,
        offset=source.offset * factor,
        root=source.root or line.root,
        held=source.held if line.held is None else line.held,
    )
