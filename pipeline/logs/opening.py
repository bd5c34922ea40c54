"""From the path of a log of any format to a recording: by the mapping that a person gives, or by a proposed one."""

from collections.abc import Mapping as AbstractMapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import pyarrow as pa

from simgap.errors import InputError
from simgap.logs.correction import corrected
from simgap.logs.formats import format_of, read_log
from simgap.logs.given import as_proposal
from simgap.logs.log import Log
from simgap.logs.mapping import Mapping, completed, read_mapping
from simgap.logs.proposal import Proposal, grouped, lacking, propose
from simgap.logs.proposal_file import proposal_path, write_proposal
from simgap.logs.rotor_order import by_place
from simgap.recordings.contract import COLUMNS, INDEX_COLUMNS, KINDS
from simgap.recordings.recording import Recording, recording_from_table
from simgap.recordings.storage import header_of, read_table


def open_recording(
    path: Path,
    kind: str | None = None,
    mapping: Path | None = None,
    platform: AbstractMapping[str, Any] | None = None,
) -> Recording:
    """Read a recording from a log of any format.

    A table with the contract's columns is read as it is; a mapping of it names only what it corrects. For any other log
    the mapping is taken, or one is proposed; a proposal that is not sure is written beside the working directory, and
    the error names it.

    Args:
        path: a file, or the folder of a format that has several files.
        kind: quadrotor, swerve or joint, where the platform says it.
        mapping: a YAML file; see `simgap.logs.mapping.read_mapping`.
        platform: its keys, where it is known: a mapping may need its gear ratio.

    Raises:
        InputError: when the log cannot be used, or a person has to say which signal is which column.
    """
    from simgap.logs.apply import at_common_times, converted, recording_of

    if mapping is not None:
        log, chosen = read_log(path), mapping_for(path, mapping, kind)
        upon = corrected(log, chosen, mapping.name, platform)
        if upon is None:
            _require_lines(log, chosen, mapping)
            return recording_of(log, chosen, platform)
        _require(log, upon, path)
        return recording_of(log, upon.mapping(), platform)
    found = recording_as_it_is(path, kind)
    if found is not None:
        return found
    log = read_log(path)
    plain = propose(log, kind)
    proposal = by_place(plain, platform)
    _require(log, proposal, path)
    columns = converted(log, proposal.mapping(), platform)
    del log
    pa.default_memory_pool().release_unused()
    recording = at_common_times(columns)
    said = proposal.notes[len(plain.notes) :]
    return replace(recording, warnings=(*recording.warnings, *said))


def mapping_for(path: Path, mapping: Path, kind: str | None = None) -> Mapping:
    """Read the mapping of a log; of a table with the contract's names it says only what it corrects.

    Args:
        path: of the log.
        mapping: a YAML file; see `simgap.logs.mapping.read_mapping`.
        kind: quadrotor, swerve or joint, where the mapping does not say it.

    Raises:
        InputError: when either cannot be read, or the mapping is wrong.
    """
    chosen = read_mapping(mapping, kind)
    return completed(chosen, header_of(path)) if _is_recording_file(path) else chosen


def recording_as_it_is(path: Path, kind: str | None = None) -> Recording | None:
    """Read a table with the contract's columns; None for any other log, which needs a mapping.

    Args:
        path: a file, or the folder of a format that has several files.
        kind: quadrotor, swerve or joint, where the platform says it.

    Raises:
        InputError: when there is no such file, or it cannot be used.
    """
    if not _is_recording_file(path):
        return None
    from simgap.logs.run_column import with_run
    from simgap.logs.sparse import recording_of_sparse

    table = with_run(read_table(path), path)
    return recording_of_sparse(table, path, kind) or recording_from_table(table, kind, str(path))


def _is_recording_file(path: Path) -> bool:
    """Whether a file is a table that is meant as a recording."""
    return format_of(path).name in ("Parquet", "CSV") and _is_recording(path)


def _is_recording(path: Path) -> bool:
    """Whether a table is meant as a recording: it has what a kind requires, or no column but the contract's."""
    present = set(header_of(path))
    known = any(present <= {*INDEX_COLUMNS, *COLUMNS[kind]} for kind in KINDS)
    return "t" in present and (known or any(not lacking(kind, present) for kind in KINDS))


def _require_lines(log: Log, chosen: Mapping, path: Path) -> None:
    """Refuse a mapping that lacks columns, with what is known of the first of them."""
    lost = lacking(chosen.kind, set(chosen.columns))
    if lost:
        known = as_proposal(log, chosen, path.name).missing
        advice = next((known[column] for column in lost if column in known), "add a line for each")
        advice = f"{advice[0].lower()}{advice[1:].rstrip('.')}"
        raise InputError(f"has no line for {grouped(lost)}, which a {chosen.kind} needs", str(path), advice)


def _require(log: Log, proposal: Proposal, path: Path) -> None:
    """Refuse to go on with a proposal that is not sure or lacks a column."""
    if proposal.refusal:
        raise InputError(proposal.refusal, str(path), f"simgap inspect {path} shows what is in it")
    lost = lacking(proposal.kind, set(proposal.columns)) if proposal.kind else []
    if lost:
        advice = proposal.missing.get(lost[0], f"simgap inspect {path} shows what is in it")
        raise InputError(f"no signal for {grouped(lost)} was found", str(path), advice)
    if not proposal.is_sure:
        doubted = min(proposal.columns.items(), key=lambda entry: entry[1].confidence, default=None)
        reason = f" ({doubted[0]}: {doubted[1].reason})" if doubted else ""
        written = write_proposal(log, proposal, proposal_path(path))
        raise InputError(
            f"which signal is which column is not clear{reason}",
            str(path),
            f"correct {written}, and give mapping={written}",
        )
