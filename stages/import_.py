"""The command that writes a log as a recording of the contract; not a stage of the pipeline."""

import argparse
import sys
from pathlib import Path
from typing import NoReturn

from simgap.runner.command import report_mistakes


def import_(path: Path, output: Path, kind: str | None = None, mapping: Path | None = None) -> None:
    """Write a log of any format as a Parquet file with the contract's columns, units and frames."""
    from simgap.logs.opening import open_recording
    from simgap.recordings.recording import write_recording

    recording = open_recording(path, kind, mapping)
    for warning in recording.warnings:
        print(f"warning: {warning}", file=sys.stderr)
    write_recording(recording, output)
    print(
        f"{len(recording.frame)} samples of {len(recording.runs)} runs of a {recording.kind}: wrote {output}"
    )


def main(argv: list[str] | None = None) -> NoReturn:
    """Run the command."""
    parser = argparse.ArgumentParser(prog="simgap import", description=import_.__doc__, allow_abbrev=False)
    parser.add_argument("path", type=Path, metavar="LOG", help="a log of any format, or the folder of one")
    parser.add_argument("--map", type=Path, metavar="FILE", help="a mapping, as simgap inspect proposes it")
    parser.add_argument(
        "--kind", choices=("quadrotor", "swerve", "joint"), help="of the machine; else it is guessed"
    )
    parser.add_argument(
        "-o", "--output", type=Path, required=True, metavar="FILE", help="the Parquet file to write"
    )
    parser.add_argument("--debug", action="store_true", help="show tracebacks")
    given = parser.parse_args(argv)

    def action() -> None:
        import_(given.path, given.output, given.kind, given.map)

    sys.exit(report_mistakes("import", given.debug, action))


if __name__ == "__main__":
    main()
