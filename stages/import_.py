"""The command that writes a log as a recording of the contract; not a stage of the pipeline."""

import argparse
import sys
from pathlib import Path
from typing import NoReturn

from simgap.errors import InputError
from simgap.runner.command import report_mistakes
from simgap.stages._log_options import LogOptions, add_log_options, log_options


def import_(path: Path, output: Path, options: LogOptions) -> None:
    """Write a log of any format as a Parquet file with the contract's columns, units and frames."""
    from simgap.logs.opening import open_recording
    from simgap.recordings.recording import write_recording

    _check_output(path, output)
    recording = open_recording(path, options.kind, options.mapping, options.platform)
    for warning in recording.warnings:
        print(f"warning: {warning}", file=sys.stderr)
    write_recording(recording, output)
    print(
        f"{len(recording.frame)} samples of {len(recording.runs)} runs of a {recording.kind}: wrote {output}"
    )


def _check_output(path: Path, output: Path) -> None:
    """Refuse a file that would replace the log, or whose name says that it is no Parquet file."""
    if output.suffix != ".parquet":
        remedy = f"write {output.with_suffix('.parquet')}"
        raise InputError("the recording is a Parquet file, and its name says otherwise", str(output), remedy)
    if output.exists() and output.samefile(path):
        raise InputError("is the log itself", str(output), "write the recording to another file")


def main(argv: list[str] | None = None) -> NoReturn:
    """Run the command."""
    parser = argparse.ArgumentParser(prog="simgap import", description=import_.__doc__, allow_abbrev=False)
    add_log_options(parser)
    parser.add_argument(
        "-o", "--output", type=Path, required=True, metavar="FILE", help="the Parquet file to write"
    )
    parser.add_argument("--debug", action="store_true", help="show tracebacks")
    given = parser.parse_intermixed_args(argv)
    sys.exit(
        report_mistakes("import", given.debug, lambda: import_(given.path, given.output, log_options(given)))
    )


if __name__ == "__main__":
    main()
