"""The command that shows what a log holds and proposes a mapping of it; not a stage of the pipeline."""

import argparse
import shlex
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

from simgap.runner.command import report_mistakes

if TYPE_CHECKING:
    from simgap.logs.log import Log
    from simgap.logs.proposal import Proposal
    from simgap.recordings.recording import Recording


def inspect(path: Path, kind: str | None = None, output: Path | None = None, every: bool = False) -> None:
    """Show what is in a log and what a diagnosis would make of it, and write a mapping that can be corrected."""
    from simgap.logs.formats import read_log
    from simgap.logs.listing import log_lines, signal_lines
    from simgap.logs.opening import recording_as_it_is
    from simgap.logs.proposal import propose
    from simgap.logs.proposal_file import write_proposal

    log = read_log(path)
    recording = recording_as_it_is(path, kind)
    if recording is not None:
        print(*signal_lines(log, recording.channels, every), "", *_prospect(recording), sep="\n")
        print(f"It has the contract's columns, so it needs no mapping: {_command(path)}")
        return
    proposal = propose(log, kind)
    print(*log_lines(log, proposal, every), "", sep="\n")
    if proposal.refusal:
        print(f"No diagnosis. {path.name}: {proposal.refusal}.")
        return
    if proposal.is_sure:
        print(*_mapped(log, proposal), sep="\n")
    else:
        print(f"No diagnosis yet: {_doubt(proposal)}.")
    written = write_proposal(log, proposal, output or Path(f"{path.name}.mapping.yaml"))
    if proposal.is_sure:
        print(f"wrote {written}: no need to give it, if it is right: {_command(path)}")
    else:
        print(f"wrote {written}: correct it, then {_command(path, written)}")


def _command(path: Path, mapping: Path | None = None) -> str:
    """Return the command that diagnoses a log, as a shell takes it."""
    given = {"recording": path} | ({"mapping": mapping} if mapping else {})
    return shlex.join(
        ["simgap", "diagnose", "platform=NAME", *(f"{key}={value}" for key, value in given.items())]
    )


def _doubt(proposal: "Proposal") -> str:
    """Say why a proposal is not enough."""
    from simgap.logs.proposal import lacking

    if proposal.kind is None:
        return "no kind of machine fits"
    lost = lacking(proposal.kind, set(proposal.columns))
    return f"no signal for {', '.join(lost[:4])} was found" if lost else "not every column is sure"


def _mapped(log: "Log", proposal: "Proposal") -> Iterator[str]:
    """Yield what a diagnosis would get by the proposed mapping."""
    from simgap.errors import InputError
    from simgap.logs.apply import recording_of
    from simgap.logs.ratio import without_ratios

    try:
        recording = recording_of(log, without_ratios(proposal.mapping()))
    except InputError as error:
        yield f"No diagnosis: {error}."
    else:
        yield from _prospect(recording)


def _prospect(recording: "Recording") -> Iterator[str]:
    """Yield what a diagnosis would get: runs, samples, doubts, and what the recording contradicts itself in."""
    from simgap.consistency import contradictions

    seconds = recording.frame.groupby("run", sort=False)["t"].agg(lambda t: t.iloc[-1] - t.iloc[0]).sum()
    runs = len(recording.runs)
    yield f"{runs} run{'' if runs == 1 else 's'}, {len(recording.frame)} samples, {seconds:.1f} s"
    yield from recording.warnings
    yield from (f"Contradiction: {each.sentence}" for each in contradictions(recording))


def main(argv: list[str] | None = None) -> NoReturn:
    """Run the command."""
    parser = argparse.ArgumentParser(prog="simgap inspect", description=inspect.__doc__, allow_abbrev=False)
    parser.add_argument("path", type=Path, metavar="LOG", help="a log of any format, or the folder of one")
    parser.add_argument(
        "--kind", choices=("quadrotor", "swerve", "joint"), help="of the machine; else it is guessed"
    )
    parser.add_argument(
        "-o", "--output", type=Path, metavar="FILE", help="the mapping; else LOG.mapping.yaml"
    )
    parser.add_argument("--all", action="store_true", help="list every signal")
    parser.add_argument("--debug", action="store_true", help="show tracebacks")
    given = parser.parse_args(argv)

    def action() -> None:
        inspect(given.path, given.kind, given.output, given.all)

    sys.exit(report_mistakes("inspect", given.debug, action))


if __name__ == "__main__":
    main()
