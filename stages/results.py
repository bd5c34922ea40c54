"""The command that writes the page of results; not a stage of the pipeline."""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

from simgap.artifacts import require_checkout
from simgap.errors import InputError
from simgap.runner.command import report_mistakes

SWEEPS = "artifacts/*/sweeps/*"


def results(sweeps: Sequence[Path], docs: Path | None = None) -> None:
    """Write the sections of docs/results.md from finished sweeps; all other sections stay as they are."""
    from simgap.comparison.page import PAGE, write_section
    from simgap.runner.comparing import FOLDER

    docs = docs or require_checkout("writing without --docs DIR") / "docs"
    folders = [sweep / FOLDER for sweep in sweeps] or _titled()
    if not folders:
        remedy = "run one: a preset of conf/experiment opens with its command"
        raise InputError("there is no sweep that has a title", SWEEPS, remedy)
    for folder in folders:
        write_section(folder, docs)
        print(f"results: wrote {folder.parent.name} into {docs / PAGE}")


def _titled() -> list[Path]:
    """Return the comparisons below the working directory that have a title."""
    from simgap.comparison.comparison import FILE, Comparison
    from simgap.runner.comparing import FOLDER

    folders = sorted(path.parent for path in Path().glob(f"{SWEEPS}/{FOLDER}/{FILE}"))
    return [folder for folder in folders if Comparison.read(folder).results.title]


def main(argv: list[str] | None = None) -> NoReturn:
    """Run the command line and exit."""
    parser = argparse.ArgumentParser(prog="simgap results", description=results.__doc__)
    parser.add_argument(
        "sweeps", nargs="*", metavar="SWEEP", type=Path, help=f"its folder; all of {SWEEPS} that have a title"
    )
    parser.add_argument("--docs", metavar="DIR", type=Path, help="where to; docs of the repository")
    parser.add_argument("--debug", action="store_true", help="show tracebacks")
    given = parser.parse_args(argv)
    sys.exit(report_mistakes("results", given.debug, lambda: results(given.sweeps, given.docs)))


if __name__ == "__main__":
    main()
