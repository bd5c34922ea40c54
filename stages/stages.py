"""What of a branch is there and what would run, for a person to read; not a stage of the pipeline."""

import argparse
import shutil
import sys
from collections.abc import Sequence
from datetime import datetime
from pathlib import Path
from typing import NoReturn

from simgap.errors import InputError
from simgap.runner.command import report_mistakes


def stages(branch: str | None = None) -> None:
    """Show the stages of a branch: what is fresh, what would run, when each ran last and where its output lies."""
    from simgap.artifacts import require_checkout
    from simgap.runner.pipeline import branches, freshness
    from simgap.runner.project import commands, nearest

    checkout = require_checkout()
    known = branches(checkout)
    branch = branch or _latest(checkout, known)
    if branch not in known:
        raise InputError(f"there is no branch {branch!r}", "dvc.yaml", nearest(branch, known))
    found, meaning = freshness(checkout, branch), commands()
    folder = Path("artifacts") / branch
    rows = [("stage", "state", "last run", "what it does")]
    for name, fresh in found.items():
        state = f"{fresh.state}: {fresh.reason}" if fresh.reason else fresh.state
        rows.append((name, state, _when(checkout / folder / name), meaning[name]))
    print(f"branch {branch}: `simgap reproduce {branch}` runs {_summary([f.state for f in found.values()])}")
    print(f"output of a stage: {folder}/STAGE\n")
    _print_table(rows)


def _latest(root: Path, known: list[str]) -> str:
    """Return the branch that was worked on last, before that the one that is reproduced by default."""
    from simgap.stages.reproduce import PREFERRED

    there = [
        (path.stat().st_mtime, path.name) for path in (root / "artifacts").glob("*") if path.name in known
    ]
    return max(there)[1] if there else PREFERRED


def _when(output: Path) -> str:
    if not output.exists():
        return "-"
    return datetime.fromtimestamp(output.stat().st_mtime).strftime("%Y-%m-%d %H:%M")


def _summary(states: list[str]) -> str:
    running = sum(state in ("would run", "never ran") for state in states)
    maybe = states.count("may run")
    return f"{running} of {len(states)} stages" + (f" and perhaps {maybe} after them" if maybe else "")


def _print_table(rows: Sequence[tuple[str, ...]]) -> None:
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    room = shutil.get_terminal_size((200, 24)).columns
    for row in rows:
        line = "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        print(line if len(line) <= room else f"{line[: room - 1]}…")


def main(argv: list[str] | None = None) -> NoReturn:
    """Run the command line and exit."""
    parser = argparse.ArgumentParser(prog="simgap stages", description=stages.__doc__)
    parser.add_argument("branch", nargs="?", help="a file of conf/branch; the one that was worked on last")
    parser.add_argument("--debug", action="store_true", help="show tracebacks")
    given = parser.parse_args(argv)
    sys.exit(report_mistakes("stages", given.debug, lambda: stages(given.branch)))


if __name__ == "__main__":
    main()
