"""A proposal as a YAML file that a person can read, correct and give back."""

import os
from pathlib import Path

import yaml

from simgap.logs.log import Log
from simgap.logs.mapping import source_to_config
from simgap.logs.proposal import Proposal


def proposal_text(log: Log, proposal: Proposal) -> str:
    """Return the file's content: one line a column, with its confidence and reason as a comment.

    Args:
        log: that it was proposed for.
        proposal: of a known kind.
    """
    lines = [
        f"# Proposed for {_one_line(Path(log.path).name)}. Correct it, then give it as mapping=THIS_FILE.",
        "# COLUMN: {from: SIGNAL, unit: UNIT, scale: FACTOR, sign: -1}",
        f"kind: {proposal.kind or '# quadrotor, swerve or joint'}",
    ]
    for column, proposed in proposal.columns.items():
        entry = yaml.safe_dump(
            source_to_config(proposed.source), default_flow_style=True, width=10_000, allow_unicode=True
        ).strip()
        lines.append(f"{column}: {entry}  # {proposed.confidence:.2f}: {_one_line(proposed.reason)}")
    lines += [f"# {column}: missing. {_one_line(advice)}" for column, advice in proposal.missing.items()]
    lines += [f"# {_one_line(note)}" for note in proposal.notes]
    if proposal.windows:
        lines.append("runs: # name: [begin, end], s of the log's clock")
        lines += [f"  {_quoted(w.name)}: [{w.begin:.6g}, {w.end:.6g}]" for w in proposal.windows]
    if proposal.rate is not None:
        lines.append(f"rate: {proposal.rate:g} # samples per second")
    return "\n".join(lines) + "\n"


def proposal_path(log: Path) -> Path:
    """Return where the proposal for a log is written, in the working directory: the log's name and an ending."""
    return Path(f"{log.name}.mapping.yaml")


def write_proposal(log: Log, proposal: Proposal, path: Path) -> Path:
    """Write a proposal; a file that is there already is kept, and a number is added to the name of another one.

    Returns:
        The path that was written.
    """
    free, number, content = path, 1, proposal_text(log, proposal)
    while free.exists():
        if free.is_file() and free.read_bytes() == content.encode():
            return free
        number += 1
        free = path.with_name(f"{path.name.removesuffix('.yaml')}-{number}.yaml")
    temporary = free.with_name(f".{free.name}.part")
    temporary.write_bytes(content.encode())
    os.replace(temporary, free)
    return free


def _one_line(text: str) -> str:
    return " ".join(text.split())


def _quoted(name: str) -> str:
    return yaml.safe_dump(name, default_style='"', width=10_000).strip()
