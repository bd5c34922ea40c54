"""The command that shows what a log holds and proposes a mapping of it; not a stage of the pipeline."""

import argparse
import shlex
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

from simgap.runner.command import report_mistakes
from simgap.stages._log_options import LogOptions, add_log_options, log_options

if TYPE_CHECKING:
    from simgap.logs.log import Log
    from simgap.logs.proposal import Proposal
    from simgap.recordings.recording import Recording


def inspect(path: Path, options: LogOptions, output: Path | None = None, every: bool = False) -> None:
    """Show what is in a log and what a diagnosis would make of it, and write a mapping that can be corrected."""
    from simgap.logs.formats import read_log
    from simgap.logs.listing import log_lines, signal_lines
    from simgap.logs.opening import recording_as_it_is
    from simgap.logs.proposal import propose
    from simgap.logs.rotor_order import by_place

    log = read_log(path)
    if options.mapping is not None:
        _show_given(log, path, options, options.mapping, every)
        return
    recording = recording_as_it_is(path, options.kind)
    if recording is not None:
        print(*signal_lines(log, recording.channels, every), "", *_prospect(recording, options), sep="\n")
        print(f"It has the contract's columns, so it needs no mapping: {_command(path, options)}")
        return
    proposal = by_place(propose(log, options.kind), options.platform)
    print(*log_lines(log, proposal, every), "", sep="\n")
    if proposal.refusal:
        print(f"No diagnosis. {path.name}: {proposal.refusal}.")
        return
    _show_proposed(log, proposal, path, options, output or Path(f"{path.name}.mapping.yaml"))


def _show_proposed(log: "Log", proposal: "Proposal", path: Path, options: LogOptions, output: Path) -> None:
    """Say what comes out with a proposal, and write it."""
    from simgap.logs.proposal_file import write_proposal

    usable = _shown(log, proposal, options)
    written = write_proposal(log, proposal, output)
    if usable:
        print(f"To diagnose it with these columns: {_command(path, options)}")
        print(f"To change one: edit {written}, which holds them, and add mapping={shlex.quote(str(written))}")
        return
    shown = shlex.join(["simgap", "inspect", str(path), "--map", str(written)])
    print(
        f"wrote {written}: if a signal of the log is what is asked for, put it in; {shown} shows what comes out"
    )
    print(f"then {_command(path, options, written)}")


def _show_given(log: "Log", path: Path, options: LogOptions, mapping: Path, every: bool) -> None:
    """Show what comes out with the mapping that a person gives."""
    from simgap.logs.correction import corrected
    from simgap.logs.given import as_proposal
    from simgap.logs.listing import log_lines
    from simgap.logs.opening import mapping_for

    chosen = mapping_for(path, mapping, options.kind)
    proposal = corrected(log, chosen, mapping.name, options.platform) or as_proposal(
        log, chosen, mapping.name
    )
    print(*log_lines(log, proposal, every), "", sep="\n")
    if _shown(log, proposal, options):
        print(f"To diagnose it: {_command(path, options, mapping)}")
    else:
        print(f"Correct {mapping}.")


def _command(path: Path, options: LogOptions, mapping: Path | None = None) -> str:
    """Return the command that diagnoses a log, as a shell takes it."""
    given = {"recording": path} | ({"mapping": mapping} if mapping else {})
    machine = options.said or ("platform=FILE",)
    return shlex.join(["simgap", "diagnose", *machine, *(f"{key}={value}" for key, value in given.items())])


def _doubt(proposal: "Proposal") -> str:
    """Say why a proposal is not enough."""
    from simgap.logs.proposal import SURE, grouped, lacking

    if proposal.kind is None:
        return "no kind of machine fits"
    lost = lacking(proposal.kind, set(proposal.columns))
    if lost:
        return f"no signal for {grouped(lost)} was found, which a {proposal.kind} needs"
    doubted = [column for column, found in proposal.columns.items() if found.confidence < SURE]
    return f"{grouped(doubted)} {'is' if len(doubted) == 1 else 'are'} not sure"


def _shown(log: "Log", proposal: "Proposal", options: LogOptions) -> bool:
    """Print what a diagnosis would get by a mapping; return whether that can be used."""
    from simgap.errors import InputError
    from simgap.logs.apply import recording_of
    from simgap.logs.ratio import without_ratios

    if not proposal.is_sure:
        print(f"No diagnosis yet: {_doubt(proposal)}.")
        return False
    mapping = proposal.mapping()
    try:
        recording = recording_of(
            log, without_ratios(mapping) if options.platform is None else mapping, options.platform
        )
    except InputError as error:
        print(f"No diagnosis: {error}.")
        return False
    print(*_prospect(recording, options), sep="\n")
    return True


def _prospect(recording: "Recording", options: LogOptions) -> Iterator[str]:
    """Yield what a diagnosis would get: runs, samples, doubts, and what the recording contradicts itself in."""
    from simgap.consistency import check, size_doubts
    from simgap.platforms import platform_from_config

    seconds = recording.frame.groupby("run", sort=False)["t"].agg(lambda t: t.iloc[-1] - t.iloc[0]).sum()
    runs = len(recording.runs)
    yield f"{runs} run{'' if runs == 1 else 's'}, {len(recording.frame)} samples, {seconds:.1f} s"
    yield from recording.warnings
    platform = None if options.platform is None else platform_from_config(options.platform)
    found = check(recording, platform)
    yield from (f"Contradiction: {each.sentence}" for each in found.contradictions)
    if not found.contradictions:
        yield from (doubts := [*found.warnings, *size_doubts(recording)])
        if not doubts:
            yield "Nothing in it contradicts itself."


def main(argv: list[str] | None = None) -> NoReturn:
    """Run the command."""
    parser = argparse.ArgumentParser(prog="simgap inspect", description=inspect.__doc__, allow_abbrev=False)
    add_log_options(parser)
    parser.add_argument(
        "-o", "--output", type=Path, metavar="FILE", help="the proposed mapping; else LOG.mapping.yaml"
    )
    parser.add_argument("--all", action="store_true", help="list every signal")
    parser.add_argument("--debug", action="store_true", help="show tracebacks")
    given = parser.parse_intermixed_args(argv)

    def action() -> None:
        inspect(given.path, log_options(given), given.output, given.all)

    sys.exit(report_mistakes("inspect", given.debug, action))


if __name__ == "__main__":
    main()
