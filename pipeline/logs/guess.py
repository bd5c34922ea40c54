"""A mapping proposed by names, units and what the signals say, for logs of no known layout."""

from simgap.logs.log import Log
from simgap.logs.proposal import Proposal


def guess(log: Log, kind: str | None) -> Proposal:
    """Propose a mapping of a log of no known layout; see `simgap.logs.proposal.propose`."""
    return Proposal(kind, {})
