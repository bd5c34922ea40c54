"""The command that shows what a log holds and proposes a mapping of it; not a stage of the pipeline."""

import argparse
import sys
from pathlib import Path
from typing import NoReturn

from simgap.runner.command import report_mistakes


def inspect(path: Path, kind: str | None = None, output: Path | None = None, every: bool = False) -> None:
    """Show what is in a log and what a diagnosis would make of it, and write a mapping that can be corrected."""
    from simgap.errors import InputError
    from simgap.logs.apply import recording_of
    from simgap.logs.formats import read_log
    from simgap.logs.listing import log_lines
    from simgap.logs.proposal import propose
    from simgap.logs.proposal_file import write_proposal

    log = read_log(path)
    proposal = propose(log, kind)
    print(*log_lines(log, proposal, every), sep="\n")
    print()
    if proposal.refusal:
        print(f"No diagnosis: {proposal.refusal}.")
        return
    written = write_proposal(log, proposal, output or Path(f"{path.name}.mapping.yaml"))
    if not proposal.is_sure:
        print(
            f"wrote {written}: correct it, then simgap diagnose platform=NAME recording={path} mapping={written}"
        )
        return
    try:
        recording = recording_of(log, proposal.mapping())
    except InputError as error:
        print(f"No diagnosis: {error}.")
    else:
        seconds = recording.frame.groupby("run", sort=False)["t"].agg(lambda t: t.iloc[-1] - t.iloc[0]).sum()
        print(f"{len(recording.runs)} runs, {len(recording.frame)} samples, {seconds:.1f} s")
        print(*recording.warnings, sep="\n")
        print(f"simgap diagnose platform=NAME recording={path}")
    print(f"wrote {written}")


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
