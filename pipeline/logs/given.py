"""A mapping that a person gives, shown as a proposal is: what it names, and what the kind still lacks."""

import yaml

from simgap.errors import InputError
from simgap.logs.apply import signal_of
from simgap.logs.log import Log
from simgap.logs.mapping import Mapping, Source, source_to_config
from simgap.logs.proposal import Proposal, Proposed, propose


def as_proposal(log: Log, mapping: Mapping, name: str) -> Proposal:
    """Return a mapping as a proposal in which every column whose signal is in the log is certain.

    Args:
        log: that it is of.
        mapping: as it was read.
        name: of its file, to say where a column comes from.
    """
    columns = {column: _said(log, source, name) for column, source in mapping.columns.items()}
    found = propose(log, mapping.kind)
    missing = {column: advice for column, advice in found.missing.items() if column not in columns}
    missing |= {column: _candidate(each) for column, each in found.columns.items() if column not in columns}
    return Proposal(mapping.kind, columns, missing, mapping.windows, rate=mapping.rate)


def _said(log: Log, source: Source, name: str) -> Proposed:
    for signal in (source.signal, source.times):
        if signal is not None and signal not in log.texts:
            try:
                signal_of(log, signal)
            except InputError as error:
                return Proposed(source, 0.0, str(error))
    return Proposed(source, 1.0, f"as {name} says")


def _candidate(found: Proposed) -> str:
    source = yaml.safe_dump(
        source_to_config(found.source), default_flow_style=True, width=10_000, sort_keys=False
    )
    return f"It may be {source.strip()}: {found.reason} ({found.confidence:.2f})."
