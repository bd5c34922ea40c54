"""The command that writes a log as a recording of the contract; not a stage of the pipeline."""

import argparse
import sys
from pathlib import Path
from typing import Any, NoReturn

from simgap.errors import InputError
from simgap.runner.command import report_mistakes

_KEYS = ("platform", "joint")


def import_(
    path: Path,
    output: Path,
    kind: str | None = None,
    mapping: Path | None = None,
    platform: dict[str, Any] | None = None,
) -> None:
    """Write a log of any format as a Parquet file with the contract's columns, units and frames."""
    from simgap.logs.opening import open_recording
    from simgap.recordings.recording import write_recording

    recording = open_recording(path, kind, mapping, platform)
    for warning in recording.warnings:
        print(f"warning: {warning}", file=sys.stderr)
    write_recording(recording, output)
    print(
        f"{len(recording.frame)} samples of {len(recording.runs)} runs of a {recording.kind}: wrote {output}"
    )


def _platform(given: list[str]) -> dict[str, Any] | None:
    """Return the keys of the platform that is given, None where none is.

    Raises:
        InputError: when something else is given, or the platform cannot be used.
    """
    pairs = dict(text.split("=", 1) for text in given if text.partition("=")[0] in _KEYS and "=" in text)
    if len(pairs) != len(given):
        raise InputError(
            "is not known here", " ".join(given), "give platform=FILE, and joint=NAME of a robot file"
        )
    if "platform" not in pairs:
        if "joint" in pairs:
            raise InputError(
                "names a joint of a robot file", f"joint={pairs['joint']}", "give platform=FILE, too"
            )
        return None
    from simgap.api.inputs import platform_config

    return platform_config(pairs["platform"], pairs.get("joint"))


def _kind_of(platform: dict[str, Any]) -> str:
    from simgap.platforms import platform_from_config

    return platform_from_config(platform).kind


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
    parser.add_argument(
        "given",
        nargs="*",
        metavar="KEY=VALUE",
        help="platform=FILE or NAME, whose kind and numbers a mapping may need; joint=NAME of a URDF or MJCF file",
    )
    parser.add_argument("--debug", action="store_true", help="show tracebacks")
    given = parser.parse_intermixed_args(argv)

    def action() -> None:
        platform = _platform(given.given)
        kind = given.kind or (_kind_of(platform) if platform is not None else None)
        import_(given.path, given.output, kind, given.map, platform)

    sys.exit(report_mistakes("import", given.debug, action))


if __name__ == "__main__":
    main()
